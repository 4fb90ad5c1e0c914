"""The window of a dataset: cleaned, split, exported, made a benchmark, and looked at, a tab each.

entropies       the entropies that decide which images are rejected
charts          how often each entropy is, and the entropy of each image, with the threshold
marks           the images that would be rejected, crossed out on the map
previews        images with what a model learns from them
tasks           what the buttons start, one at a time
tab             what all tabs have in common
clean_tab       the tab that shows what a threshold would do, and asks for the rest
cleaning        from a dataset's folder to what that tab shows, and what its buttons do
split_tab       images given to training, validation and test
benchmark_tab   ways to Processing's windows for benchmarks
export_tab      formats of other programs
labels_tab      images with their parts, labels and depths
window          the window around the tabs
datasets        which dataset is open, and which tab has read it
"""
