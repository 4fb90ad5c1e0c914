"""What is asked of a flight, and the plan that comes of it.

In reading order:

- `parts`: what is asked beside area, camera and wind: every field with all that there is to say of it
- `area`: where a mission goes, as a box, a polygon or points
- `coords`: areas in text
- `area_files`: polygons in GeoJSON, KML and KMZ files
- `pose_table`: poses in a table with a header
- `cameras`: cameras by name, those that ship and the user's own
- `imageries`: several sources, dates or map types by name
- `wind`: what a mission is flown in
- `mission`: all that is asked, as one value of parts, in and out of JSON
- `earlier`: mission files of earlier versions
- `presets`: values for a purpose, to begin with
- `options`: what the command takes for it
- `settings`: a mission from command line, environment and file
- `layout`: where captures stand and what their pictures show of the area
- `no_fly`: captures over no-fly areas, which are left out
- `gusts`: gusts and the aircraft in them, discretised exactly
- `flight`: legs and clock, and poses in wind
- `relief`: how high captures over relief are, and what they surely see
- `methods`: the kind of picture and its methods, by the error budget
- `path`: what an aircraft flies: take-off, ways, lead-ins, captures and turns, in sorties
- `plan`: a mission worked out, as arrays
- `pilot`: sorties, the camera's interval and the sun
- `alignment`: rows along the longest side of an area, or for the shortest flight
- `estimate`: what a plan takes and gives, in figures
- `outlines`: what is drawn of a plan, cut at the antimeridian
- `export`: a plan in files
"""
