"""Where pixels come from: sources, their transport and their catalogue."""
