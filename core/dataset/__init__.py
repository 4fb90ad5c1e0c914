"""What a capture leaves: the table of its images, and what is worked out from them."""
