"""The page of moving walkers: what it is told (`contents`), how it is put together (`page`), and its widget."""
