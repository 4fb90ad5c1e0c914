"""The run that turns a plan into georeferenced images; resumable."""
