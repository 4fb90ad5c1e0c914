"""The window of a dataset: tabs for cleaning, splitting, exporting, benchmarks and labels.

entropies       the entropies that decide which images are rejected
charts          histogram and bar chart of the entropies, with the threshold
marks           crosses on the map over images that would be rejected
previews        images with their training data
tasks           tasks started by the buttons, one at a time
tab             base of the tabs
clean_tab       tab that shows the effect of a threshold
cleaning        data and actions of the cleaning tab
split_tab       tab for dividing images into training, validation and test parts
benchmark_tab   tab that opens Processing's benchmark windows
export_tab      tab for export to formats of other programs
labels_tab      tab that shows images with their parts, labels and depths
window          the window around the tabs
datasets        the dataset open in the window, and the tabs that have read it
"""
