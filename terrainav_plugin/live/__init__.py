"""The live view: the picture of a camera that is moved on the map or follows the planned flight.

source      opens the camera of the entered mission, and takes its pictures, on any thread
feed        takes the picture of the newest pose in the background
flight      poses along the flight of a plan
recording   poses recorded one after another, and the mission that captures them
marks       camera, heading and footprint on the map
tool        the map tool that moves and turns the camera
dock        the panel with the picture and the entries of the pose
view        keeps picture, map and entries at one pose
"""
