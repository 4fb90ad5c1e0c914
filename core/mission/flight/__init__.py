"""How a mission is flown, in time and in wind.

- `wind`: what a mission is flown in
- `gusts`: gusts and the aircraft in them, discretised exactly
- `legs`: legs between captures and the time they take
- `motion`: poses in wind
- `direct`: the flight from capture to capture, without turns
- `path`: what an aircraft flies: take-off, ways, lead-ins, captures and turns, in sorties
- `alignment`: rows along the longest side of an area, or for the shortest flight
- `pilot`: sorties, the camera's interval and the sun
"""
