"""The mission panel, and the plugin's page in QGIS's options.

dock            entries, figures, buttons and captures, from top to bottom
form            all entries, as a state that is remembered between sessions
start           entry of the first image's capture time
headings        summaries beside the titles of folded groups
presets         chooser of a preset
entries         groups of entries that are fields of the state
sections        flight, output and less common entries
elevation       entry of elevation sources
camera          entries of the camera, with a chooser of cameras
imagery         entries of the imagery, with a chooser of the source
choices         the sources and cameras to choose from
source_list     the list of sources, kept up to date
source_dialogs  dialogs for the user's sources
figures         figures of a plan as text
planning        plans of the mission entered
alignment       rows aligned to the area
runs            captures of this session
options_page    the plugin's page in QGIS's options
"""
