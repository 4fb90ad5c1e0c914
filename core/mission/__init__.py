"""Missions as users ask for them, and the plans made from them.

In reading order:

- `parts`: the fields of a mission beside area, camera and wind, each declared with title, help, unit and limits
- `areas`: boxes, polygons and points, from text and files
- `clock`: units and plausibility of times
- `pose_table`, `litchi_table`: poses from tables with a header, and from Litchi missions
- `cameras`: cameras by name, shipped and added by users
- `sensors`: image sensors by name, with the figures of their data sheets
- `imageries`: named combinations of source, date and map type
- `mission`: the mission, one value made of parts, to and from JSON
- `lenses`: cameras of captures, whose lenses may vary
- `sunlight`: the sun of a mission
- `presets`: starting values for mapping, navigation and machine learning
- `options`: options of the command
- `settings`: a mission from command line, environment and configuration file
- `layout`: positions and frames of captures, their coverage and overlap
- `flight`: wind and gusts, legs and times, the path with its sorties, the alignment of rows
- `relief`: the ground below a mission, heights of captures, the ground that they see
- `methods`: the kind of picture and the methods that fit the error budget
- `resolution`: ground sample distances of a plan
- `views`: ground that the cameras of a plan see
- `plan`: a planned mission, as arrays
- `takes`: when and from where the rows of a picture are exposed
- `profile`: heights of flight, ground and surface along the path of a plan
- `inside`: captures that lie wholly on the source's imagery
- `estimate`: figures of a plan: time, bytes, coverage, overlap
- `outlines`: geometries to draw of a plan, cut at the antimeridian
- `export`: files of a plan for other programs
"""
