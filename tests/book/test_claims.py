"""Sentences bound to data: wrong data stop the build."""

import os

import pytest
from book_claims import sentences
from figures import claims
from figures.claims import ConclusionFails, claim, mutations, told


@pytest.fixture(autouse=True)
def nothing_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(claims, "KEPT", tmp_path / "told.json")
    monkeypatch.setattr(claims, "FOUND", tmp_path / "claims")
    monkeypatch.delitem(os.environ, "LAB_BOOK_READ", raising=False)
    (tmp_path / "told.json").write_text('{"rms": [7.4], "joint is better": [6.0, 7.4]}')


@pytest.mark.parametrize("wrong", [-7.4, 3.7, 7.9])
def test_a_number_that_moved_stops_the_build(wrong):
    told("rms", 7.41)
    with pytest.raises(ConclusionFails, match="read the sentence again"):
        told("rms", wrong)


def test_a_conclusion_that_is_false_stops_the_build():
    with pytest.raises(ConclusionFails, match="the runs say otherwise"):
        claim("joint is better", lambda e: e[0] < e[1], e=(7.4, 6.0))


@pytest.mark.parametrize(("kind", "wrong"), [*mutations((6.0, 7.4))])
def test_every_mutation_of_the_data_stops_the_build(kind, wrong):
    claim("joint is better", lambda e: e[0] < e[1], e=(6.0, 7.4))
    with pytest.raises(ConclusionFails):
        claim("joint is better", lambda e: e[0] < e[1], e=wrong)


def test_sentences_that_count_are_those_with_a_number_or_a_comparison():
    text = """---
kernelspec: x
---
# Title

It errs by {glue:text}`rms` mm. It is an arm. One is larger than the other. At 5 Hz it rings.

```{code-cell}
x = "5 mm"
```

$$
a = 5 mm
$$

| Claim | 3 mm |
"""
    assert [s.split()[0] for s in sentences(text)] == ["It", "One", "At", "|"]
