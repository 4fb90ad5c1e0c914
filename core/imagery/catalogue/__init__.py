"""The sources known by name, with what their providers allow: those shipped, and the user's own."""
