"""What ratings say of walkers: their means, traits made of them, and how far observers agree.

Of the other rooms it imports `analysis`.
"""
