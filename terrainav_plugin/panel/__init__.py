"""The mission panel: what is typed, chosen and shown there, and QGIS's page of the plugin's settings.

dock            entries, figures, buttons and captures, one below the other
form            the entries together, as the state that they make, remembered between sessions
start           the entry of the first image's capture time
headings        titles of groups, with what they hold
presets         the chooser of a preset
entries         groups of entries that are fields of the state
sections        flight, output, and what most missions leave as it is
elevation       the entry of sources of heights
camera          the entries of the camera, and the cameras to choose from
imagery         the entries of the imagery, and the chooser of the source
choices         the sources to choose from
source_list     these as the project's layers come and go, and as the user adds and removes some
source_dialogs  dialogs for sources of one's own
figures         the figures of a plan in the user's words
planning        from what is entered to a plan
alignment       rows turned so that they suit the area
runs            the captures of this session
options_page    the plugin's settings, among QGIS's own
"""
