import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from eigenwalker.experiment.dealing import deal_cards


@given(st.integers(1, 30), st.integers(0, 25), st.integers(0, 2**31), st.data())
def test_every_card_comes_up_equally_often_and_once_in_a_hand(n_cards, n_hands, seed, data):
    n_hand = data.draw(st.integers(1, n_cards))
    counts = np.zeros(n_cards, dtype=int)
    for hand in deal_cards(n_cards, n_hand, n_hands, np.random.default_rng(seed)):
        assert len(set(hand.tolist())) == n_hand
        counts[hand] += 1
        assert np.ptp(counts) <= 1


def test_a_hand_larger_than_the_deck_is_refused():
    with pytest.raises(ValueError, match="at most as many cards as the deck, 3, got 4"):
        deal_cards(3, 4, 1, np.random.default_rng(0))
