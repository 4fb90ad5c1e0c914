"""Flight of a mission in time and wind.

- `wind`: wind and turbulence of a mission
- `gusts`: gusts and the aircraft in them, discretised exactly
- `legs`: legs between captures and the time they take
- `motion`: poses in wind
- `varied`: poses that differ at random from the planned ones
- `deviates`: random numbers that are the same on every machine
- `direct`: the flight from capture to capture, without turns
- `path`: the path of an aircraft: take-off, transits, lead-ins, captures and turns, in sorties
- `rates`: velocities and turn rates of cameras at captures
- `alignment`: rows along the longest side of an area, or for the shortest flight
- `pilot`: sorties, image interval and sun
- `joined`: several missions flown as one
"""
