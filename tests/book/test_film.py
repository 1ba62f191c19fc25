"""The film on the first page: as long as its captions say, small, and fetched only when played."""

import itertools

import imageio.v2 as imageio
import pytest
from figures import film


def test_the_captions_cover_a_film_of_a_minute_without_a_gap():
    """Each caption starts where the one before ends; the last ends after sixty seconds."""
    captions = film.captions()
    assert captions[0][0] == 0
    assert all(a[1] == b[0] for a, b in itertools.pairwise(captions))
    assert captions[-1][1] == 60


def test_the_film_is_as_long_as_its_captions_and_small():
    """To half a second, and at most 3 MB; its poster weighs at most 40 kB."""
    with imageio.get_reader(film.FILM) as reader:
        told = reader.get_meta_data()
    assert told["duration"] == pytest.approx(film.captions()[-1][1], abs=0.5)
    assert film.FILM.stat().st_size <= 3e6
    assert film.POSTER.stat().st_size <= 40e3


@pytest.mark.slow
def test_the_film_waits_for_a_click_and_has_captions(visit):
    """Nothing of it but the poster is loaded with the page; the captions are the list below it."""
    page = visit("index.html")
    loaded = page.evaluate("performance.getEntriesByType('resource').map(e => e.name).join(' ')")
    assert film.FILM.name not in loaded
    video = page.locator(".lab-film video")
    assert video.get_attribute("preload") == "none"
    cues = video.evaluate(
        "v => [...v.textTracks[0].cues].map(c => [c.startTime, c.endTime, c.text])"
    )
    assert [tuple(cue) for cue in cues] == film.captions()
