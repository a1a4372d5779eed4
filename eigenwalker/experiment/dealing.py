"""Random subsets in which everything comes up equally often."""

import numpy as np
from numpy.typing import NDArray

__all__ = ["deal_cards"]


def deal_cards(n_cards: int, n_hand: int, n_hands: int, random: np.random.Generator) -> list[NDArray[np.intp]]:
    """Return hands of different cards, dealt from one shuffled deck after another.

    After every hand, no card has been dealt more than once more often than another.

    Parameters
    ----------
    n_cards, n_hand, n_hands : int
        In a deck; of a hand, not more than there are cards; and hands.
    random : Generator
        Shuffles each deck, and each hand.

    Returns
    -------
    list of ndarray of int of shape (n_hand,)
        Numbers of cards, in random order.

    Raises
    ------
    ValueError
        If a hand has more cards than the deck.
    """
    if n_hand > n_cards:
        raise ValueError(f"a hand must have at most as many cards as the deck, {n_cards}, got {n_hand}")
    hands, left = [], list(random.permutation(n_cards))
    for _ in range(n_hands):
        hand = left[:n_hand]
        left = left[n_hand:]
        if len(hand) < n_hand:
            # What is in the hand already stays in the new deck for the next one, so that no hand has a card twice.
            deck = list(random.permutation(n_cards))
            fresh = [card for card in deck if card not in hand]
            taken = [card for card in deck if card in hand]
            lacking = n_hand - len(hand)
            hand, left = hand + fresh[:lacking], taken + fresh[lacking:]
        hands.append(random.permutation(np.array(hand, dtype=np.intp)))
    return hands
