"""What is plugged in and cannot be used: one line, exit code 2, nothing written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper

from costeer.cli import main
from costeer.records.record import read_record
from tests.methods.rivals import FILE

LAW = FILE.read_text("utf-8")
BOMB = "a: &a [x,x,x,x,x,x,x,x]\n" + "".join(
    f"{new}: &{new} [{','.join([f'*{old}'] * 8)}]\n"
    for old, new in zip("abcdefg", "bcdefgh", strict=True)
)

FILES = {
    "no_step.py": LAW.replace("    step=step,\n", "    step=None,\n"),
    "returns_int.py": LAW.replace("integral=0.0)", "integral=0)"),
    "int_gain.py": LAW.replace("yaw: Real = 25.0", "yaw: Real = 25"),
    "one_value.py": LAW.replace("return State(integral), As", "return As"),
    "broken.py": LAW.replace("import array", "import arrray"),
    "raises.py": LAW.replace(
        "    applied =",
        "    if measured.longitudinal_position > 20:\n"
        "        raise ValueError('seen')\n    applied =",
    ),
    "picky.py": LAW.replace(
        "strength=condition.strength_factor",
        "strength=1 / (condition.name != 'strong-normal')",
    ),
    "empty.py": "",
    "two.py": LAW + "\nOTHER = METHOD\nANOTHER = METHOD\ndel METHOD\n",
    "no_column.py": LAW.replace('"method.integral"', '"method.sum"'),
    "sure.py": "def PREDICTOR(window):\n    return 2.0\n",
    "raising.py": "def PREDICTOR(window):\n    return window[999, 0]\n",
    "number.py": "PREDICTOR = 5\n",
    "field.yaml": "mass: 1500\ncolour: 3\n",
    "word.yaml": "mass: heavy\n",
    "light.yaml": "mass: 0.001\n",
    "list.yaml": "- mass\n",
    "tab.yaml": "mass: [\n",
    "bomb.yaml": BOMB,
    "damaged.npz": "PK no archive",
}

# A car of 100 m passes in 5 s: the window of the predictor is full after 3 s.
SHORT = ["--length", "100", "--engine", "python"]


def network(inputs: int, outputs: int, path: Path) -> None:
    """An ONNX model whose answer is the last numbers of the last sample."""
    given = helper.make_tensor_value_info(
        "window", TensorProto.FLOAT, [None, 180, inputs]
    )
    said = helper.make_tensor_value_info("p", TensorProto.FLOAT, None)
    ends = [[0, 179, 0], [1, 180, outputs], [0, 1, 2]]
    constants = [
        helper.make_tensor(name, TensorProto.INT64, [3], numbers)
        for name, numbers in zip(("from", "to", "axes"), ends, strict=True)
    ]
    cut = helper.make_node("Slice", ["window", "from", "to", "axes"], ["cut"])
    squashed = helper.make_node("Sigmoid", ["cut"], ["p"])
    graph = helper.make_graph([cut, squashed], "g", [given], [said], constants)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)])
    model.ir_version = 9
    onnx.save(model, path)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("plug_ins")
    for name, text in FILES.items():
        (folder / name).write_text(text, "utf-8")
    network(7, 1, folder / "seven.onnx")
    network(6, 2, folder / "twofold.onnx")
    network(6, 1, folder / "fits.onnx")
    (folder / "no.onnx").write_bytes(b"no model")
    np.savez(folder / "other.npz", weights=np.zeros(3))
    return folder


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("--method no_step.py", "has no step function"),
        ("--method returns_int.py", "integral of the state a number, it was a whole"),
        ("--method int_gain.py", "parameter yaw of method 'pi-keeping' is a whole"),
        ("--method one_value.py", "give the new state and assistance"),
        ("--method broken.py", "cannot be loaded: ImportError"),
        ("--method empty.py", "has no Method"),
        ("--method two.py", "has the Method OTHER, ANOTHER; give one of them the name"),
        ("--method no_column.py", "has no 'sum'"),
        ("--method missing.py", "there is no file"),
        ("--method ibsh", "did you mean ibhs?"),
        ("--predictor sure.py", "predictor PREDICTOR says 2"),
        ("--predictor raising.py", "predictor PREDICTOR broke: IndexError"),
        ("--predictor number.py", "5 is no predictor; give a function"),
        ("--predictor grru", "predictor 'grru' is not known (did you mean gru?)"),
        ("--weights damaged.npz", "damaged.npz"),
        ("--weights other.npz", "other.npz"),
        ("--weights missing.npz", "missing.npz: No such file"),
        ("--weights seven.onnx", "takes window tensor(float) [None, 180, 7]"),
        ("--weights twofold.onnx", "answers a window with 2 numbers"),
        ("--weights no.onnx", "is no ONNX model"),
        ("--car field.yaml", "there is no parameter 'colour'"),
        ("--car word.yaml", "mass is 'heavy'; give a number"),
        ("--car light.yaml", "mass is 0.001; give a number from 15 to 150000 kg"),
        ("--car list.yaml", "is no list of names and numbers"),
        ("--car tab.yaml", "is not YAML"),
        ("--car bomb.yaml", "a is "),
        ("--car missing.yaml", "missing.yaml: No such file"),
        ("--car lorry", "car 'lorry' is not known"),
        ("--driver field.yaml", "there is no parameter 'mass'"),
        ("--parameters bomb.yaml", "bomb.yaml: a is "),
        ("--set guidance.lateral_gain=1", "did you mean guidance.lateral_error_gain"),
        ("--set guidance.lateral_error_gain=9e9", "give a number from 0 to"),
        ("--set guidance.lateral_error_gain=nan", "give a number from 0 to"),
        ("--set guidance.lateral_error_gain", "sets nothing; give NAME=NUMBER"),
        ("--set car.mass=1 --set car.mass=2", "car.mass is set twice"),
        ("--set road.length=200", "road.length is set by --length"),
        (
            "--intention off --method raises.py",
            "step of method 'pi-keeping' broke: ValueError: seen",
        ),
        ("--method picky.py", "parameters of method 'pi-keeping' broke: ZeroDivision"),
        ("--intention off --predictor sure.py", "intention 'off' asks no predictor"),
        ("--intention off --weights fits.onnx", "intention 'off' asks no predictor"),
        ("--predictor gur --weights fits.onnx", "do not go together"),
        ("--predictor sure.py --weights fits.onnx", "do not go together"),
    ],
)
def test_it_is_refused_in_one_line(
    options: str,
    message: str,
    files: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(files)
    out = tmp_path / "t.parquet"
    assert main(["simulate", "--out", str(out), *SHORT, *options.split()]) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 1
    assert message in said[0]
    assert len(said[0]) < 600
    assert not list(tmp_path.iterdir())


def test_all_that_fits_is_driven_and_recorded(
    files: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(files)
    (tmp_path / "car.yaml").write_text("about: loaded\nmass: 1900\n", "utf-8")
    out = tmp_path / "t.parquet"
    plugged = ["--method", str(FILE), "--weights", "fits.onnx", "--set", "offset=2"]
    plugged += ["--car", str(tmp_path / "car.yaml"), "--set", "column.friction=0.3"]
    assert main(["simulate", "--out", str(out), *SHORT, *plugged]) == 0
    record = read_record(out)
    about = record.metadata
    configuration = about["configuration"]
    assert isinstance(configuration, dict)
    assert (about["method"], about["predictor"]) == ("pi-keeping", "fits")
    assert len(str(about["intention_model_hash"])) == 64
    assert configuration["controller"]["offset"] == 2.0
    assert configuration["car"]["mass"] == 1900.0
    assert configuration["column"]["friction"] == 0.3
    probabilities = record.columns["crossing_probability"]
    assert np.isnan(probabilities[:179]).all()
    assert ((probabilities[179:] > 0.0) & (probabilities[179:] < 1.0)).all()


def test_parameters_are_listed_with_unit_range_and_source(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    assert main(["parameters", "--method", str(FILE), "offset", "--json"]) == 0
    shown = capsys.readouterr().out
    assert '"name": "controller.offset"' in shown
    assert '"unit": "N·m/m"' in shown
    assert main(["parameters", "guidnace"]) == 2


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--scenario", "expressway-curves", "--intention", "network"), True),
        (("--scenario", "expressway-curves", "--intention", "scripted"), False),
        (("--scenario", "expressway", "--intention", "network"), False),
    ],
)
def test_who_lets_the_shipped_network_read_a_road_with_bends_is_told(
    options: tuple[str, ...],
    told: bool,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    out = str(tmp_path / "trial.parquet")
    assert main(["simulate", "--out", out, "--length", "100", *options]) == 0
    assert ("has bends" in capsys.readouterr().err) == told
