"""Many recordings at once: which they are, what came out, and what changed."""
