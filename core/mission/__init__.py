"""What is asked of a flight, and the plan that comes of it.

In reading order:

- `parts`: what is asked beside area, camera and wind: every field with all that there is to say of it
- `areas`: where a mission goes: boxes, polygons and points, in texts and files
- `clock`: which times the poses of a flight may have
- `pose_table`, `litchi_table`: poses in a table with a header, and images of a Litchi mission
- `cameras`: cameras by name, those that ship and the user's own
- `imageries`: several sources, dates or map types by name
- `mission`: all that is asked, as one value of parts, in and out of JSON
- `presets`: values for a purpose, to begin with
- `options`: what the command takes for it
- `settings`: a mission from command line, environment and file
- `layout`: where captures stand and what their pictures show of the area
- `flight`: how it is flown: wind and gusts, legs and clock, the path with its sorties, rows aligned for it
- `relief`: the ground below a mission: heights of captures, and what they surely see
- `methods`: the kind of picture and its methods, by the error budget
- `resolution`: ground sample distances of a plan
- `views`: what the cameras of a plan see
- `plan`: a mission worked out, as arrays
- `inside`: which captures show the source's imagery alone
- `estimate`: what a plan takes and gives, in figures
- `outlines`: what is drawn of a plan, cut at the antimeridian
- `export`: a plan in files
"""
