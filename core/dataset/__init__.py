"""Read, clean, split, label, load and convert datasets of captured images.

folder     names of files and folders, and choices of the commands
cells      cells of a CSV table and the numbers in them
table      read and write ``meta_data.csv``
stored     images that are objects of a store or ranges of shards
geotiff    GeoTIFFs with bands other than 8-bit grey or colour
cameras    what the pixels of an image mean
dataset    read a dataset: map types, tables, image files
label_images  class and instance of each pixel
published  positions and flights in the names of the paper's published data
vectors    check a dataset's GeoJSON before another program opens it
vbn        the paper's Night Vision supplement
entropy    entropies of images, and which of them decides
figures    diagrams of entropies
clean      mark and move images with too little detail
ground     the ground that images show, and blocks of it
split      training, validation and test parts
labels     scaled positions of images in metres
convert    copy published datasets with TerrAInav's columns

``loading`` is a separate room.
"""
