"""The counter of words: what is a sentence, which have no verb, and that the documentation is within its budgets."""

import importlib

import pytest

pytestmark = [
    pytest.mark.extra("textblob"),
    pytest.mark.filterwarnings("ignore:unclosed file:ResourceWarning"),  # TextBlob leaves its lexicon open
]


@pytest.fixture(scope="module")
def words():
    """The counter, which needs TextBlob."""
    return importlib.import_module("docs.words")


def sentences(words, text):
    return [sentence for paragraph in words.paragraphs(text) for sentence in words.sentences(paragraph)]


@pytest.mark.parametrize(
    ("text", "split"),
    [
        ("The leg hops. It lands.", ["The leg hops.", "It lands."]),
        ("It takes 2.5 m/s. See Fig. 3 for it.", ["It takes 2.5 m/s.", "See Fig. 3 for it."]),
        ("See: J. Ramos, Y. Ding and K. Sim, e.g. Fig. 2.", ["See: J. Ramos, Y. Ding and K. Sim, e.g. Fig. 2."]),
        ("It weighs 20 N. It hops.", ["It weighs 20 N.", "It hops."]),
        ('He said "stop." Then (it stopped.) And rested.', ['He said "stop."', "Then (it stopped.)", "And rested."]),
        ("Does it? `load` knows! θ is an angle.", ["Does it?", "CODE knows!", "θ is an angle."]),
        ("One line\ngoes on.", ["One line goes on."]),
    ],
)
def test_where_a_sentence_ends(words, text, split):
    assert sentences(words, text) == split


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("# A heading\n\n| a | b |\n| --- | --- |\n| c | d |\n\nThe text stays.", ["The text stays."]),
        ("```python\nprint('no.')\n```\n\nYes.", ["Yes."]),
        ("A [link](page.md#there) and `code` are words.", ["A link and CODE are words."]),
        ("A {term}`return map` and {term}`cycles <cycle>` are words.", ["A return map and cycles are words."]),
        ("The mass $m$ and $$x = y$$ are formulas.", ["The mass X and formula are formulas."]),
        ("**A heading.** The text *stays* **here**.", ["The text stays here."]),
        ("- One item.\n- Another one.", ["One item.", "Another one."]),
        ("```{note}\nIt counts.\n```\n\n:::{grid}\n:gutter: 2\n:::", ["It counts."]),
        (
            "```{glossary}\nhop\n  A jump. It repeats.\n\nrun\n  Another one.\n```",
            ["A jump.", "It repeats.", "Another one."],
        ),
        ("---\ntitle: no\n---\nIt begins here.", ["It begins here."]),
    ],
)
def test_what_is_read(words, text, read):
    assert sentences(words, text) == read


def test_length_counts_words_only(words):
    assert words.length("It takes 3 - 4 s, or more …") == 7


@pytest.mark.parametrize(
    ("sentence", "has"),
    [
        ("The spring engages at touchdown.", True),
        ("You can change it.", True),
        ("Run the command.", True),
        ("The force is F = 0.", True),
        ("Two readings of RA.", False),
        ("Multipliers of all gaits in one unit circle.", False),
    ],
)
def test_finds_verbs(words, sentence, has):
    assert words.has_verb(sentence) is has


def test_a_page_is_counted_and_judged(words, tmp_path):
    page = tmp_path / "page.md"
    long = f"The leg is {'very ' * 40}long."
    page.write_text(f"# Title\n\n{long} No verb here. It begins from cold.\n\nand a rest.", encoding="utf-8")
    read = words.read(page, ["from cold"])
    assert read.words == 55 and len(read.sentences) == 4
    assert read.long == [long] and read.verbless == ["No verb here."]
    assert read.forbidden == [("It begins from cold.", "from cold")]


def test_says_what_is_beyond_a_budget(words, monkeypatch):
    monkeypatch.setattr(words, "BUDGETS", {"readme": 10, "manual": 10, "longest": 5, "median": 3, "verbless": 0.1})
    long = "It is a sentence of seven words."
    page = words.Page(words.DOCS / "page.md", 20, [long, "No verb."], [(long, "seven")])
    readme = words.Page(words.ROOT / "README.md", 5, [], [])
    assert words.complaints([readme, page]) == [
        "docs/page.md: a sentence of 7 words, at most 5",
        "manual: 20, at most 10",
        "median: 4.5, at most 3",
        "verbless: 0.5, at most 0.1",
        "docs/page.md: 'seven', which the glossary forbids",
    ]
    assert words.complaints([]) == []


def test_the_glossary_forbids_words_and_does_not_use_them(words):
    forbidden = words.forbidden_words()
    assert forbidden and words.read(words.GLOSSARY, forbidden).forbidden == []


def test_results_and_what_is_made_are_no_part_of_the_manual(words):
    names = {path.relative_to(words.ROOT).as_posix() for path in words.pages()}
    assert {"README.md", "docs/index.md", "docs/results/speed.md"} <= names
    assert not any(name.startswith(("docs/api/", "docs/gallery/")) for name in names)


def test_the_documentation_is_within_its_budgets(words):
    forbidden = words.forbidden_words()
    assert words.complaints([words.read(path, forbidden) for path in words.pages()]) == []
