"""A dataset cleaned by eye: its entropies, a threshold, and what would be rejected by it.

entropies   the entropies that decide which images are rejected
charts      how often each entropy is, and the entropy of each image, with the threshold
panel       the window: shows what it is given, and asks for the rest
marks       the images that would be rejected, crossed out on the map
tasks       what the buttons start
cleaning    from a dataset's folder to what is shown, and what the buttons do
"""
