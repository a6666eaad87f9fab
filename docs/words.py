"""Count the words of the documentation and judge its sentences: `python -m docs.words [PAGE ...] [--all]`.

It prints a row for each page: words, sentences, their median length, and how many are longer than 30 words, have no
verb, or use a word that the glossary forbids. Then it prints those sentences. It fails where a budget of `words.toml`
is exceeded. TextBlob finds the verbs, and is sometimes wrong.
"""

import argparse
import re
import statistics
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

from markdown_it import MarkdownIt
from textblob.en import tag

DOCS = Path(__file__).parent
ROOT = DOCS.parent
BUDGETS = tomllib.loads((DOCS / "words.toml").read_text(encoding="utf-8"))
GLOSSARY = DOCS / "reference" / "glossary.md"
RESULTS = DOCS / "results"
MADE = ("api", "gallery")  # by the site
BOLD = "\N{BULLET}"  # stands around bold text until a heading within a line is found
HEAD = re.compile(rf"^{BOLD}[^{BOLD}]*[.:]{BOLD}|{BOLD}")
LONG = 30  # words
# verbs here, which the tagger takes for nouns
VERBS = set(
    "acts advances alternate answer answers averages bounces bounds breaks cause change changes chatters checks "
    "clears costs counts cuts damps doubles draws ends engages estimates fall falls favour fits fixes flexes follows "
    "gains gallops holds hops installs jumps land lands latches lifts limits lists loads locks lower lowers maps "
    "marks minimises move moves names need needs opens overheats pays plays plots point points presses print prints "
    "releases return returns rolls rounds runs samples scales sets share shares ships show shows slides slips splits "
    "starts states sticks stops store stores strikes suit suits swings touches trails trots turns type updates works "
    "yields".split()
)
ORDERS = set(
    "change click compare cut draw find lock look plot print read run save search see set start type use watch".split()
)
ABBREVIATION = re.compile(
    r"\b(e\.g|i\.e|cf|vs|al|Appl|Fig|Figs|Eq|Eqs|Mech|Proc|Sec|No|resp|approx|St)\.$|(?:^|[,;(:] |\band )[A-Z]\.$"
)
STATEMENT = re.compile(r"[A-Z0-9(\"'].*[.!?][)\"']*$", re.S)  # not what goes on after a block
ROLE = re.compile(r"\{[\w:-]+\}`([^`<]+?)(?:\s*<[^`]*>)?`")


@dataclass(frozen=True)
class Page:
    """What was counted on a page.

    Attributes:
        path: of the page.
        words: all between white space that has a letter or a digit, code and tables included.
        sentences: those outside code, tables and headings.
        forbidden: sentences with a word that the glossary forbids, and the word.
    """

    path: Path
    words: int
    sentences: list[str]
    forbidden: list[tuple[str, str]]

    @property
    def long(self) -> list[str]:
        """Sentences of more than 30 words."""
        return [sentence for sentence in self.sentences if length(sentence) > LONG]

    @property
    def verbless(self) -> list[str]:
        """Sentences that end with a full stop and have no verb."""
        return [sentence for sentence in self.sentences if STATEMENT.match(sentence) and not has_verb(sentence)]


def pages() -> list[Path]:
    """List the README and all pages that people wrote."""
    written = sorted(path for path in DOCS.rglob("*.md") if path.relative_to(DOCS).parts[0] not in MADE)
    return [ROOT / "README.md", *written]


def paragraphs(text: str) -> list[str]:
    """Return the running text of a page: code becomes one word, links their text; tables and headings are left out."""
    text = re.sub(r"\A---\n.*?\n---\n", "", text, flags=re.S)
    text = re.sub(r"^:::.*$|^:[\w-]+:.*$|^\([\w-]+\)=$", "", text, flags=re.M)
    text = re.sub(r"\$\$.*?\$\$", "formula", text, flags=re.S)
    text = re.sub(r"\$[^$\n]+\$", "X", text)
    text = ROLE.sub(r"\1", text)
    tokens = MarkdownIt("commonmark").enable("table").parse(text)
    found, skipped = [], 0
    for token in tokens:
        if token.type in ("table_open", "heading_open"):
            skipped += 1
        elif token.type in ("table_close", "heading_close"):
            skipped -= 1
        elif token.type == "fence" and token.info.startswith("{glossary}"):
            found += paragraphs(re.sub(r"^\S.*$|^ +", "", token.content, flags=re.M))
        elif token.type == "fence" and token.info.startswith(("{note}", "{tip}", "{warning}")):
            found += paragraphs(token.content)
        elif token.type == "inline" and not skipped:
            found.append(HEAD.sub("", "".join(plain(child) for child in token.children or [])).strip())
    return found


def plain(token) -> str:
    """Return what a reader sees of a part of a paragraph; what is bold stands between marks."""
    if token.type in ("strong_open", "strong_close"):
        return BOLD
    if token.type in ("softbreak", "hardbreak"):
        return " "
    if token.type == "code_inline":
        return "CODE"
    return token.content if token.type == "text" else ""


def sentences(paragraph: str) -> list[str]:
    """Split a paragraph where a full stop ends a sentence."""
    found = [""]
    for part in re.split(r"(?<=[.!?])\s+(?=[\"'(]?[^\Wa-z_])|(?<=[.!?][)\"'])\s+(?=[A-Z])", paragraph):
        found[-1] = f"{found[-1]} {part}".strip()
        if not ABBREVIATION.search(found[-1]):
            found.append("")
    return [sentence for sentence in found if length(sentence) > 0]


def length(sentence: str) -> int:
    """Count the words of a sentence."""
    return sum(1 for word in sentence.split() if re.search(r"\w", word))


def has_verb(sentence: str) -> bool:
    """Tell whether a sentence has a verb, as far as the tagger sees."""
    spoken = sentence.replace("CODE", "it")
    if sentence.split()[0].lower() in ORDERS or " = " in sentence:
        return True
    return any(kind.startswith(("VB", "MD")) or word.lower() in VERBS for word, kind in tag(spoken))


def forbidden_words() -> list[str]:
    """List the words that the glossary says not to use: its entries end with lines such as *Not: a, b.*."""
    if not GLOSSARY.is_file():
        return []
    lines = re.findall(r"\*Not: (.*?)\.\*", GLOSSARY.read_text(encoding="utf-8"), re.S)
    return sorted({word.strip() for line in lines for word in line.split(",")})


def read(path: Path, forbidden: list[str]) -> Page:
    """Count a page."""
    text = path.read_text(encoding="utf-8")
    spoken = [re.sub(r"\bNot: .*", "", paragraph) for paragraph in paragraphs(text)]
    found = [sentence for paragraph in spoken for sentence in sentences(paragraph)]
    used = [
        (sentence, word)
        for sentence in found
        for word in forbidden
        if re.search(rf"\b{re.escape(word)}\b", sentence, re.IGNORECASE)
    ]
    return Page(path, length(text), found, used)


def complaints(read_pages: list[Page]) -> list[str]:
    """Say which budgets are exceeded."""
    total = sum(page.words for page in read_pages if RESULTS not in page.path.parents and page.path.parent != ROOT)
    all_sentences = [sentence for page in read_pages for sentence in page.sentences]
    median = statistics.median(map(length, all_sentences or [""]))
    verbless = sum(len(page.verbless) for page in read_pages) / max(1, len(all_sentences))
    found = [
        f"{page.path.relative_to(ROOT)}: a sentence of {length(sentence)} words, at most {BUDGETS['longest']}"
        for page in read_pages
        for sentence in page.sentences
        if length(sentence) > BUDGETS["longest"]
    ]
    readme = sum(page.words for page in read_pages if page.path.parent == ROOT)
    for name, value in (("readme", readme), ("manual", total), ("median", median), ("verbless", verbless)):
        if value > BUDGETS[name]:
            found.append(f"{name}: {value:.4g}, at most {BUDGETS[name]:g}")
    found += [
        f"{page.path.relative_to(ROOT)}: {word!r}, which the glossary forbids"
        for page in read_pages
        for _, word in page.forbidden
    ]
    return found


def main() -> None:
    """Print the table and what exceeds its budget."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pages", nargs="*", type=Path, help="some pages; without any, all")
    asked = parser.parse_args().pages
    forbidden = forbidden_words()
    counted = [read(path.resolve(), forbidden) for path in asked or pages()]
    print(f"{'page':<46}{'words':>7}{'sentences':>11}{'median':>8}{'long':>6}{'no verb':>9}{'forbidden':>11}")
    for page in counted:
        median = statistics.median(map(length, page.sentences)) if page.sentences else 0
        print(
            f"{page.path.relative_to(ROOT)!s:<46}{page.words:>7}{len(page.sentences):>11}{median:>8.0f}"
            f"{len(page.long):>6}{len(page.verbless):>9}{len(page.forbidden):>11}"
        )
    for page in counted if asked else []:
        print(*(f"long: {sentence}" for sentence in page.long), sep="\n")
        print(*(f"no verb: {sentence}" for sentence in page.verbless), sep="\n")
        print(*(f"{word!r}: {sentence}" for sentence, word in page.forbidden), sep="\n")
    manual = sum(page.words for page in counted if RESULTS not in page.path.parents and page.path.parent != ROOT)
    print(f"manual, without results and README: {manual} words")
    if found := complaints(counted):
        sys.exit("\n".join(found) if not asked else f"{len(found)} complaints")


if __name__ == "__main__":
    main()
