"""Plans that cannot be are refused with their line, before anybody sits down."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from costeer.cli import main
from costeer.runtime.setup import DriveSetup, drive_parameters
from costeer.sessions.plan import session_steps, trial_of
from costeer.sessions.plan_file import paper_plan_text, parsed_plan, read_plan
from costeer.sessions.plan_words import check_words
from costeer.sessions.scenarios import scenario_beside, scenario_notes
from costeer.sessions.session import Session

HEAD = "title: a\nsteps:\n  - {kind: instruct, text: welcome}\n"


@pytest.mark.parametrize(
    ("step", "said"),
    [
        ("{kind: practise, condition: manual, minutes: 5}", "longest_minutes is nan"),
        ("{kind: break, minutes: -5}", "minutes is -5; give 0 to 120"),
        ("{kind: break, minutes: 900}", "minutes is 900; give 0 to 120"),
        ("{kind: drive, condition: manual, conditions: [manual]}", "conditions says"),
        ("{kind: ask, instrument: ssq, minutes: 3}", "minutes says nothing here"),
        ("{kind: instruct}", "has no text"),
        (
            "{kind: practise, condition: manual, minutes: 1, longest_minutes: 2, "
            "sdlp_below: -1}",
            "sdlp_below is -1 m; give 0.05 to 2,",
        ),
        (  # centimetres: everybody would pass
            "{kind: practise, condition: manual, minutes: 1, longest_minutes: 2, "
            "sdlp_below: 40}",
            "sdlp_below is 40 m; give 0.05 to 2,",
        ),
        ("{kind: drive}", "names no condition; give one of manual, strong-rapid,"),
        ("{kind: consent}", "names no instrument, as instrument: consent"),
        ("{kind: drive, condition: Manual}", "did you mean manual"),
        (
            "{kind: trials, conditions: [weak-rapid], break_every: 1, minutes: -3}",
            "minutes is -3",
        ),
        ("{kind: trials, conditions: [weak-rapid, weak-rapid]}", "name each once"),
        (
            "{kind: trials, conditions: [weak-rapid], after: [{kind: drive}]}",
            "entry 1: kind 'drive' is none of ask, instruct",
        ),
    ],
)
def test_a_step_that_cannot_be_is_refused_with_its_line(step: str, said: str) -> None:
    with pytest.raises(ValueError, match=f"line 4: step 2 .*{said}"):
        parsed_plan(f"{HEAD}  - {step}\n")


@pytest.mark.parametrize("written", [".inf", ".nan", "1:30", "010", "!!int ''"])
def test_no_number_of_a_step_is_another_than_it_seems(written: str) -> None:
    # YAML 1.1 reads 1:30 as 90 and 010 as 8; NaN would mean "not given".
    shown = written.removeprefix("!!int ''")
    with pytest.raises(ValueError, match=f"line 4: minutes is {re.escape(shown)}[,;]"):
        parsed_plan(f"{HEAD}  - {{kind: break, minutes: {written}}}\n")


def labels(steps: str) -> list[tuple[str, int, str]]:
    """Label, occasion and id of every trial of a plan."""
    plan = parsed_plan(f"{HEAD}{steps}")
    trials = [each for each in session_steps(plan, 2) if each.kind == "drive"]
    return [(each.label, each.occasion, each.id) for each in trials]


def test_condition_that_is_driven_again_has_a_label_of_its_own() -> None:
    manual = "  - {kind: drive, condition: manual%s}\n"
    block = "  - {kind: trials, order: given, conditions: [weak-rapid, manual]}\n"
    assert labels(manual % "" + block + manual % ", label: after") == [
        ("manual", 1, "drive-manual"),
        ("weak-rapid", 1, "drive-weak-rapid"),
        ("manual-2", 2, "drive-manual-2"),
        ("manual-after", 3, "drive-manual-after"),
    ]


def test_occasions_are_counted_by_scenario() -> None:
    manual = "  - {kind: drive, condition: manual%s}\n"
    there = manual % ", scenario: obstacle"
    assert labels(manual % "" + there + manual % "" + there) == [
        ("manual", 1, "drive-manual"),
        ("manual-obstacle", 1, "drive-manual-obstacle"),
        ("manual-2", 2, "drive-manual-2"),
        ("manual-obstacle-2", 2, "drive-manual-obstacle-2"),
    ]


def test_labels_do_not_follow_the_order_in_which_somebody_drives() -> None:
    block = "  - {kind: trials, label: dry, conditions: [manual, weak-rapid]}\n"
    plan = parsed_plan(f"{HEAD}{block}{block.replace('dry', 'wet')}")
    found = [
        {
            (e.label, e.condition, e.occasion)
            for e in session_steps(plan, slot)
            if e.label
        }
        for slot in (1, 2)
    ]
    assert found[0] == found[1]
    assert ("weak-rapid-wet", "weak-rapid", 2) in found[0]


def test_what_follows_a_trial_bears_its_label() -> None:
    asked = "  - {kind: ask, instrument: nasa-tlx}\n"
    manual = "  - {kind: drive, condition: manual}\n"
    plan = parsed_plan(f"{HEAD}{manual}{asked}{manual}{asked}")
    found = [(e.id, e.label) for e in session_steps(plan, 1) if e.kind == "ask"]
    assert found == [
        ("ask-nasa-tlx-manual", "manual"),
        ("ask-nasa-tlx-manual-2", "manual-2"),
    ]


@pytest.mark.parametrize(
    ("label", "said"),
    [
        ("after", "manual-after is driven in step 2 too"),
        ("After", "label is 'After'; give 1 to 20 small letters"),
        ("../x", "label is '../x'"),
        ("a" * 21, "give 1 to 20"),
    ],
)
def test_labels_that_tables_could_not_tell_apart_are_refused_with_their_line(
    label: str, said: str
) -> None:
    first = "  - {kind: drive, condition: manual, label: after}\n"
    second = f'  - {{kind: drive, condition: manual, label: "{label}"}}\n'
    with pytest.raises(ValueError, match=f"line 5: step 3 .*{said}"):
        parsed_plan(f"{HEAD}{first}{second}")


MINE = "name: mine\nspeed: 80 km/h\nroad: {length: 900}\n"


@pytest.mark.parametrize(
    ("plan", "said"),
    [
        ("title: a\nscenario: nowhere\n", r"line 2: scenario 'nowhere' is not known"),
        ("title: a\nscenario: mine.yaml\n", "line 2: scenario mine.yaml is not there"),
        ("title: a\nscenario: /mine.yaml\n", "line 2: .*beside the plan"),
        ("title: a\nscenario: ../mine.yaml\n", "line 2: .*beside the plan"),
        ("title: a\nscenario: bad.yaml\n", "line 2: bad.yaml, line 1: nome"),
        ("title: a\nspeed_kmh: 5\n", "drive-manual: speed is"),
    ],
)
def test_scenarios_that_cannot_be_are_refused_with_their_line(
    tmp_path: Path, plan: str, said: str
) -> None:
    (tmp_path / "bad.yaml").write_text(MINE.replace("name", "nome"))
    file = tmp_path / "plan.yaml"
    file.write_text(f"{plan}steps: [{{kind: drive, condition: manual}}]\n")
    with pytest.raises(ValueError, match=said):
        read_plan(file)


def test_scenario_of_a_drive_is_refused_with_the_line_of_the_drive() -> None:
    drive = "  - {kind: drive, condition: manual, scenario: obstacel}\n"
    with pytest.raises(ValueError, match=r"line 4: step 2 .*did you mean obstacle"):
        parsed_plan(f"{HEAD}{drive}")


def test_curves_too_tight_for_the_speed_are_refused_with_their_line(
    tmp_path: Path,
) -> None:
    road = "road: {length: 900, stations: [{at: 0, radius: 160}]}\n"
    (tmp_path / "bend.yaml").write_text(f"name: bend\nspeed: 50 km/h\n{road}")
    file = tmp_path / "plan.yaml"
    drive = "{kind: drive, condition: manual, scenario: bend.yaml}"
    file.write_text(f"title: a\nspeed_kmh: 110\nsteps:\n  - {drive}\n")
    with pytest.raises(ValueError, match=r"line 4: step 1 .*scenario bend"):
        read_plan(file)


def test_scenario_gives_length_and_speed_unless_the_plan_does(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(MINE)
    file = tmp_path / "plan.yaml"
    head = (
        "title: a\nscenario: mine.yaml\n%ssteps: [{kind: drive, condition: manual}]\n"
    )

    def driven(more: str = "") -> tuple[float, float, str]:
        file.write_text(head % more)
        session = Session(tmp_path)
        session.begin("P01") if not session.people() else None
        trial = session.trial_of("P01", session.standing("P01").step)
        session.close()
        return trial.length, trial.speed, trial.scenario.name  # type: ignore[union-attr]

    assert driven() == (900.0, pytest.approx(80.0 / 3.6), "mine")
    (tmp_path / "session.sqlite").unlink()
    more = "length: 500\nspeed_kmh: 60\n"
    assert driven(more) == (500.0, pytest.approx(60.0 / 3.6), "mine")


@pytest.mark.parametrize(("length", "driven"), [("", 12_000), ("length: 8000\n", 8000)])
def test_a_length_is_a_length_and_none_is_that_of_the_road(
    tmp_path: Path, length: str, driven: float
) -> None:
    (tmp_path / "long.yaml").write_text(MINE.replace("900", "12000"))
    file = tmp_path / "plan.yaml"
    step = "steps: [{kind: drive, condition: manual}]\n"
    file.write_text(f"title: a\nscenario: long.yaml\n{length}{step}")
    plan = read_plan(file)
    scenario = scenario_beside("long.yaml", tmp_path)
    trial = trial_of(plan, session_steps(plan, 1)[0], 1, scenario)
    assert drive_parameters(DriveSetup(trial)).road.length == driven


def test_a_length_beyond_the_road_is_told(tmp_path: Path) -> None:
    drive = "{kind: drive, condition: manual, scenario: obstacle}"
    plan = parsed_plan(f"title: a\nlength: 1501\nsteps: [{drive}]")
    told = scenario_notes(plan, tmp_path)
    assert any("longer than the 1500 m of scenario obstacle" in each for each in told)
    assert scenario_notes(plan._replace(length=1500.0), tmp_path) == []


def test_who_has_begun_keeps_the_scenario_they_began_with(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(MINE)
    (tmp_path / "plan.yaml").write_text(
        "title: a\nscenario: mine.yaml\nsteps: [{kind: drive, condition: manual}]\n"
    )
    session = Session(tmp_path)
    session.begin("P01")
    session.close()
    (tmp_path / "mine.yaml").write_text(MINE.replace("900", "700"))
    again = Session(tmp_path)
    assert again.plan_version == 2
    again.begin("P02")
    step = again.standing("P01").step
    lengths = [again.trial_of(who, step).length for who in ("P01", "P02")]
    again.close()
    assert lengths == [900.0, 700.0]


def test_a_plan_from_elsewhere_brings_its_scenarios(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(MINE)
    plan = tmp_path / "my-plan.yaml"
    plan.write_text(
        "title: a\nscenario: mine.yaml\nsteps: [{kind: drive, condition: manual}]\n"
    )
    given = ["session", "new", str(tmp_path / "study"), "--plan", str(plan)]
    assert main(given) == 0
    assert (tmp_path / "study" / "mine.yaml").read_text() == MINE
    Session(tmp_path / "study").close()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("scenario: expressway-curves", True),
        ("scenario: expressway-curves\nintention: indicator", False),
        ("scenario: expressway", False),
    ],
)
def test_who_plans_that_the_network_reads_bends_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: str, told: bool
) -> None:
    plan = tmp_path / "mine.yaml"
    plan.write_text(
        f"title: a\n{words}\nsteps: [{{kind: drive, condition: strong-normal}}]\n"
    )
    given = ["session", "new", str(tmp_path / "study"), "--plan", str(plan)]
    assert main(given) == 0
    assert ("has bends" in capsys.readouterr().err) == told


@pytest.mark.parametrize(
    ("head", "said"),
    [
        ("title: ' '", "title is empty"),
        ("title: a\nseed: -1", "seed is -1; give 0 to"),
        (
            "title: a\nparameters: {traffic.nothing: 1}",
            "no parameter 'traffic.nothing'",
        ),
    ],
)
def test_a_head_that_cannot_be_is_refused_with_the_file(head: str, said: str) -> None:
    with pytest.raises(ValueError, match=f"mine.yaml: .*{said}"):
        parsed_plan(f"{head}\nsteps: [{{kind: drive, condition: manual}}]", "mine.yaml")


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        (("instrument: nasa-tlx}", "instrument: tlx}"), "no instrument 'tlx'"),
        (("language: en", "language: xx"), "no language 'xx'"),
        (("text: welcome", "text: welcom"), "'welcom' is no page (did you mean welco"),
        (("text: welcome", "text: our_welcome"), "our_welcome_text under pages in te"),
    ],
)
def test_words_that_are_not_there_are_refused_before_anybody_begins(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    changed: tuple[str, str],
    said: str,
) -> None:
    plan = tmp_path / "mine.yaml"
    plan.write_text(paper_plan_text().replace(*changed))
    given = ["session", "new", str(tmp_path / "study"), "--plan", str(plan)]
    assert main(given) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "study").exists()


def test_the_words_of_a_study_count_as_words(tmp_path: Path) -> None:
    (tmp_path / "instruments").mkdir()
    item = "{name: at_ease, kind: yes_no}"
    (tmp_path / "instruments/mine.yaml").write_text(f"items: [{item}]")
    plan = parsed_plan("title: a\nsteps: [{kind: ask, instrument: mine}]")
    with pytest.raises(ValueError, match="lacks words in 'en'"):
        check_words(plan, tmp_path)
    (tmp_path / "texts").mkdir()
    words = "instruments: {mine: {title: Mine, items: {at_ease: At ease}}}"
    (tmp_path / "texts/en.yaml").write_text(words)
    check_words(plan, tmp_path)
    with pytest.raises(ValueError, match="lacks words in 'de'"):
        check_words(plan, tmp_path, "de")


def test_a_plan_in_another_encoding_is_refused_by_its_name(tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_bytes("title: Fahrt übers Land".encode("latin-1"))
    with pytest.raises(ValueError, match=r"plan\.yaml, line 1: .* save it as UTF-8"):
        Session(tmp_path)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b"title: a\nlength: 1e4\n", "line 2: length is '1e4'.* without an exponent"),
        (b"title: a\nsteps:\n", "line 2: steps has no value; give a list"),
        (b"title: a\nsteps:\n\t- {}\n", "line 3: a tab indents this line"),
        (b"title: \0a\n", "line 1: a control character stands there"),
        ("title: \u904b\u8ee2\n".encode("shift_jis"), "line 1: .* save it as UTF-8"),
        ("title: a\n".encode("utf-16"), "line 1: .* save it as UTF-8"),
        (b"title: " + b"[" * 3000, "nested deeper than any plan"),
    ],
)
def test_a_text_that_is_no_plan_is_refused_with_its_line_in_plain_words(
    text: bytes, said: str
) -> None:
    with pytest.raises(ValueError, match=f"^mine.yaml.*{said}"):
        parsed_plan(text, "mine.yaml")


def test_words_that_yaml_takes_for_false_are_read_as_they_stand() -> None:
    plan = parsed_plan(f"intention: off\nlanguage: no\n{HEAD}")
    assert (plan.intention, plan.language) == ("off", "no")


def test_a_plan_of_several_megabytes_is_refused_at_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = tmp_path / "mine.yaml"
    plan.write_text(f"{HEAD}about: {'x' * 1_000_000}\n")
    given = ["session", "new", str(tmp_path / "study"), "--plan", str(plan)]
    assert main(given) == 2
    assert "at most 0.2 MB are read" in capsys.readouterr().err


def test_blanks_of_the_consent_are_told_until_they_are_filled(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["session", "new", str(tmp_path / "s")]) == 0
    assert "blanks: contact, duration, ethics, inst" in capsys.readouterr().err
    (tmp_path / "t/texts").mkdir(parents=True)
    names = ("contact", "duration", "ethics", "institution")
    filled = ", ".join(f"{name}: x" for name in names)
    (tmp_path / "t/texts/en.yaml").write_text(f"blanks: {{{filled}}}")
    assert main(["session", "new", str(tmp_path / "t")]) == 0
    assert "blanks:" not in capsys.readouterr().err
