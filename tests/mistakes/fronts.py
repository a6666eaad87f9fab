"""Mistakes in what shows, keeps and asks: pages and plots, files, commands."""

from tests.mistakes.mutation import mistakes_in

MUTATIONS = [
    *mistakes_in(
        "references/check",
        ["references/test_check"],
        {
            "answers have twice the bounds": ("if each.off > each.bound]", "if each.off > 2.1 * each.bound]"),
            "NaN is right": ('else float("inf")', "else 0.0"),
            "events that are left out are right": ("if not wrong and not others:", "if not wrong:"),
        },
    ),
    *mistakes_in(
        "printable",
        ["test_printable"],
        {
            "escapes reach the terminal": ("char.isprintable() or", "True or"),
            "letters of which nothing is seen are shown": ("char not in _UNSEEN and", ""),
        },
    ),
    *mistakes_in(
        "studies/tables/units",
        ["studies/identification/test_records"],
        {
            "ns taken for us": ('"ns": 1e-9', '"ns": 1e-6'),
            "Unix time in ms taken for s": ('("s", "ms", "us", "ns") if', '("s", "us", "ns") if'),
        },
    ),
    *mistakes_in(
        "studies/identification/records",
        ["studies/identification/test_records"],
        {"times of an absolute clock": ("t = (t - t[0]) * TIMES", "t = t * TIMES")},
    ),
    *mistakes_in(
        "studies/tables/readings",
        ["studies/identification/test_records"],
        {"wraps that stay": ("if wraps.any():", "if not wraps.size:")},
    ),
    *mistakes_in(
        "studies/identification/search",
        ["studies/identification/test_estimate"],
        {"releases told from about when they are": ("entry.origin + float(value)", "float(value)")},
    ),
    *mistakes_in(
        "viz/playback/mesh_limits",
        ["viz/playback/test_meshes"],
        {
            "nodes that are put often count once": (
                "faces += max((count for _, count in more), default=0)",
                "faces += 0",
            ),
            "counts of STL that lie are believed": ("if len(data) == 84 + 50 * said:", "if True:"),
        },
    ),
    *mistakes_in(
        "files",
        ["test_files"],
        {
            "files written in place": (
                'target.with_name(f".{target.name}.{os.getpid()}.{next(_numbers)}.tmp")',
                "target",
            ),
            "a failed file left behind": (
                "its folder may be none\n                temporary.unlink",
                "its folder may be none\n                temporary.exists",
            ),
        },
    ),
    *mistakes_in(
        "viz/notebook/sketches",
        ["viz/notebook/test_cards"],
        {
            "multipliers outside the circle look like those inside": ("abs(z) < 1.0)", "abs(z) < 9.0)"),
            "slides drawn as bones": ("if place.translation.any()]", "]"),
        },
    ),
    *mistakes_in(
        "viz/plots/columns",
        ["viz/plots/test_columns"],
        {
            "lines across what is left out": ("gaps(trajectory) + 1", "gaps(trajectory)[:0]"),
        },
    ),
    *mistakes_in(
        "viz/playback/cables",
        ["viz/playback/test_cables"],
        {
            "a cable that is not engaged seems taut": ("acts[:, None] & (share > PULLS)", "share > PULLS"),
            "a cable has no length": ("swapaxes(0, 1)[1:]", "swapaxes(0, 1)[:-1]"),
        },
    ),
    *mistakes_in(
        "viz/playback/grafting",
        ["viz/playback/test_grafting"],
        {
            "a robot from behind is its mirror image": ("[-1.0, -1.0, 1.0, 1.0]", "[-1.0, 1.0, 1.0, 1.0]"),
            "links drawn as if every joint were at its zero": ("[turn.zero] if", "[0.0] if"),
        },
    ),
    *mistakes_in(
        "viz/playback/meshes",
        ["viz/playback/test_meshes"],
        {
            "a mesh from anywhere": ("path.is_relative_to(folder) and", "True or"),
            "a link to anywhere": ("regular(path).resolve().suffix", "regular(path).suffix"),
            "more faces than a page holds": ("while len(light.faces) > most", "while len(light.faces) > 9 * most"),
        },
    ),
    *mistakes_in(
        "studies/payoff/verdict",
        ["studies/payoff/test_verdict"],
        {
            "a saving that one start shows": ("if any(max(group.costs) <= share", "if any(min(group.costs) <= share"),
            "no saving where one start shows none": ("share * max(group.costs) for", "share * min(group.costs) for"),
            "one start is as good as two": ("STARTS = 2 ", "STARTS = 1 "),
            "any two stiffnesses are one": ("<= SAME * max(one, other)", "<= 9.0 * max(one, other)"),
            "a finer mesh is a start": ("for outcome in here if not outcome.again)", "for outcome in here)"),
        },
    ),
    *mistakes_in(
        "gaits/sensitivity/margins",
        ["gaits/sensitivity/test_margins"],
        {
            "what an event comes near to on its way is no margin": ("others[:-1] if other[0] < first[0]]", "()]"),
            "an event that has happened has a margin left": ("(event.name, 0.0,", "(event.name, 9e9,"),
        },
    ),
    *mistakes_in(
        "studies/payoff/hop_search",
        ["studies/payoff/test_hop_search"],
        {
            "a hop beyond its limits is the best": ("if each[1].missed <= MISSED]", "]"),
            "motors do without reserve": (
                'at_least[f"reserve_{part}"] = getattr(motors, part), 0.0',
                "_ = getattr(motors, part), 0",
            ),
            "the knee may come down to the ground": (
                'at_least |= {f"margin_fall:{part}"',
                '_ = {f"margin_fall:{part}"',
            ),
            "springs push at the end": ("release_springs(start.system) if", "start.system if"),
            "the kind changes with a spring": ("_towards(gait, kind, 0.0, here)", "gait"),
        },
    ),
    *mistakes_in(
        "studies/payoff/knee",
        ["studies/payoff/test_paths", "studies/payoff/test_hop_search"],
        {
            "a fixed spring stays where it rested": (
                "else _resting(other)\n\n\ndef with_knee",
                "else other\n\n\ndef with_knee",
            ),
            "a cable counts as a knee": ("float(levers(system)[-1]) ** 2", "1.0"),
            "a cable is lost": ("unilateral=False, path=spring.path)", "unilateral=False)"),
        },
    ),
    *mistakes_in(
        "studies/hop_led",
        ["studies/test_hop_led"],
        {"a way goes on beyond a fold": ("/ span < -BACK", "/ span < -9.0")},
    ),
    *mistakes_in(
        "cli/dynamics",
        ["cli/test_dynamics"],
        {"degrees on the command line": ("else np.array(arguments.q)", "else np.radians(arguments.q)")},
    ),
    *mistakes_in(
        "cli/__init__",
        ["cli/test_main"],
        {
            "a mistake ends with status 0": (
                'one_line(str(error), most)}")\n        return 2',
                'one_line(str(error), most)}")\n        return 0',
            ),
        },
    ),
]
