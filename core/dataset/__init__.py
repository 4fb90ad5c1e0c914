"""What becomes of captures: datasets read, cleaned, split, labelled, loaded, converted.

folder     what files and folders are called, and what commands choose among
cells      cells of a table in CSV, and the numbers in them
table      ``meta_data.csv``, in and out
stored     images that are objects, or ranges of shards
geotiff    images of other bands than 8-bit grey or colours
dataset    a dataset as it is read: map types, tables, image files
published  what names say beside the tables of the paper's published data
vectors    GeoJSON of a dataset, checked before another program opens it
vbn        the paper's Night Vision supplement
entropy    how much there is to see in an image, and which entropy decides over it
figures    diagrams of entropies
clean      images with too little to see are marked and moved
ground     the ground that images show, and blocks of it
split      parts for training, validation and test
labels     where images are, in metres of one frame, scaled
convert    datasets of others as ours

loading is a room of its own.
"""
