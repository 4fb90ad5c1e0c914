"""The mission panel, and the plugin's page in QGIS's options.

dock            entries, figures, buttons and captures, from top to bottom
form            all entries, as a state that is remembered between sessions
pages           tabs of the entries, each of which scrolls
keyboard        Tab in reading order, and a letter for every button and entry
start           entry of the first image's capture time
headings        summaries next to the titles of folded groups
presets         chooser of a preset
entries         groups of entries that are fields of the state
sections        the groups for flight, output and less common entries
offers          entry of names, with a menu that offers some
elevation       entry of elevation sources
layers          entries of labels and buildings, from the layers of the project
camera          entries of the camera, with a chooser of cameras
imagery         entries of the imagery, with a chooser of the source
imagery_list    list of a mission's imageries
imagery_dialog  dialog that adds an imagery
choices         the sources and cameras offered by the choosers
source_list     the list of sources, kept up to date
source_dialogs  dialogs for the user's sources
figures         figures of a plan as text
planning        plans the entered mission, and shows the figures
alignment       aligns the rows to the area
speed           enters the greatest airspeed that the camera allows
runs            the list of this session's captures
options_page    the plugin's page in QGIS's options
"""
