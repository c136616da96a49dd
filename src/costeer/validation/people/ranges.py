"""What is compared with people, and which range it is held to.

One rule for all ranges. Where the targets M1 to M12 or the project's issue give a
range, it is that. Else the drivers' median must lie in the middle half of people's
values (25 to 75 %: over drivers where there are drivers, else over lane changes), a
share in the 95 % interval of people's share (Wilson). Of drift two sets are known:
one instrumented car with a careful driver, which is too low for most people, and
filmed vehicles, too high by the error of the film; the range goes from the lower
quartile of the first to the upper quartile of the second. Ranges were computed once
from the shared half of the recordings and stand here as numbers, so that a verdict
does not depend on who has the recordings; a test holds them to the recordings where
these are present. What is only reported has no range (NaN). Lane changes of
NGSIM are those of real traffic: drivers of another domain are not held to them.
"""

from __future__ import annotations

from math import nan
from typing import NamedTuple

from costeer.base.array import Real
from costeer.drivers.population import TRAFFIC
from costeer.validation.people.findings import MEAN, MEDIAN, SHARE


class Quantity(NamedTuple):
    """One quantity that is compared; fields as of `RealComparison`.

    Attributes:
        name: R1, R2, ...
        quantity: What it is.
        unit: Of all values.
        source: Name of the recordings.
        published: 10 %, 50 % and 90 % as printed elsewhere, NaN where nothing is.
        low: Smallest accepted value, NaN where it is reported only.
        high: Largest accepted value, NaN likewise.
        statistic: "median", "mean" or "share".
        reason: Why drivers and people may differ.
        domain: Of driving, if the quantity depends on it; else empty.
    """

    name: str
    quantity: str
    unit: str
    source: str
    published: tuple[Real, Real, Real]
    low: Real
    high: Real
    statistic: str
    reason: str
    domain: str = ""


_NGSIM = "NGSIM US-101 and I-80 (ngsim_lc)"
_HEADS = "Brain4Cars (brain4cars_head)"
_LEEDS = "Goodridge et al. 2022 (leeds_steering_onset)"
_R3 = "R3 highway (r3_driving)"
_FILMED = "NGSIM I-80 (ngsim_i80_following)"
_UDACITY = "Udacity CH2 (udacity_steering)"

_DENSE = "Dense traffic at about 10 m/s, lane change of median 3.0 m, smoothed tracks."
_CLIPPED = "The end of a slow lane change is often outside the picture."
_CAMERA = (
    "Heads of ten drivers on US roads, right-hand traffic mirrored; few lane changes."
)
_DESKTOP = (
    "People must first notice a line that appears suddenly, at a desktop wheel whose "
    "ratio is not published; virtual drivers watch the road all the time."
)
_ONE_CAR = "One instrumented car in Korea, careful drivers, lane lines from a camera."
_FILM = "Tracking error of the film adds to the drift; dense traffic, 5 to 12 m/s."
_BENDS = (
    "Real roads bend and are crowned, the sensor has an offset of 0.1 to 0.2 N·m; "
    "ours is a straight road: reported, no target."
)
_UNKNOWN = (nan, nan, nan)


def _only(middle: Real) -> tuple[Real, Real, Real]:
    """Percentiles of which only the median was printed."""
    return nan, middle, nan


_CHANGES = (
    Quantity(
        "R1",
        "lane-change duration (lateral speed above 0.1 m/s)",
        "s",
        _NGSIM,
        (4.2, 5.6, 7.7),
        5.0,
        6.3,
        MEDIAN,
        _DENSE,
        TRAFFIC,
    ),
    Quantity(
        "R2",
        "lateral shape, RMS from the quintic, each lane change",
        "%",
        _NGSIM,
        _UNKNOWN,
        0.0,
        5.0,
        MEDIAN,
        "People's own shapes vary more than their mean does; tracks are noisy.",
        TRAFFIC,
    ),
    Quantity(
        "R3",
        "lateral shape, RMS from the quintic, mean shape",
        "%",
        _NGSIM,
        _UNKNOWN,
        0.0,
        5.0,
        MEAN,
        "",
        TRAFFIC,
    ),
    Quantity(
        "R4",
        "peak lateral speed",
        "m/s",
        _NGSIM,
        (0.65, 0.91, 1.23),
        0.75,
        1.1,
        MEDIAN,
        f"{_DENSE} Ours are 3.5 m.",
        TRAFFIC,
    ),
    Quantity(
        "R5",
        "onset (0.1 m/s) to largest lateral speed",
        "s",
        _NGSIM,
        (1.1, 2.5, 3.9),
        2.0,
        3.0,
        MEDIAN,
        f"It stands for the crossing, which is not marked. {_CLIPPED}",
        TRAFFIC,
    ),
    Quantity(
        "R6",
        "lane-change duration (annotated from video)",
        "s",
        "Driessen et al. 2022 (gps_lane_changes)",
        _only(4.8),
        nan,
        nan,
        MEDIAN,
        "13 lane changes, start and end as an observer saw them: reported, no target.",
    ),
)

_GLANCES = (
    Quantity(
        "R7",
        "lane changes out with a glance (17 deg) to that side",
        "%",
        _HEADS,
        _only(84.0),
        80.0,
        90.0,
        SHARE,
        _CAMERA,
    ),
    Quantity(
        "R8",
        "lane changes back with a glance (14 deg) to that side",
        "%",
        _HEADS,
        _only(83.0),
        80.0,
        90.0,
        SHARE,
        _CAMERA,
    ),
    Quantity(
        "R9",
        "first glance before the wheel touches, out",
        "s",
        _HEADS,
        _only(4.2),
        2.8,
        5.2,
        MEDIAN,
        "Windows end at 6 s, so earlier glances are not seen.",
    ),
    Quantity(
        "R10",
        "first glance before the wheel touches, back",
        "s",
        _HEADS,
        _only(2.8),
        2.36,
        3.7,
        MEDIAN,
        "Windows end at 6 s, so earlier glances are not seen.",
    ),
    Quantity(
        "R11",
        "false glances in 6 s of straight driving",
        "%",
        _HEADS,
        _only(15.0),
        12.0,
        18.0,
        SHARE,
        "People look aside for other reasons too: 18 % in the shared half of the set.",
    ),
    Quantity(
        "R12",
        "lane changes out with a look over the shoulder (34 deg)",
        "%",
        _HEADS,
        _UNKNOWN,
        52.1,
        77.6,
        SHARE,
        _CAMERA,
    ),
    Quantity(
        "R13",
        "lane changes back with a look over the shoulder (34 deg)",
        "%",
        _HEADS,
        _UNKNOWN,
        27.3,
        60.9,
        SHARE,
        _CAMERA,
    ),
)

_STEERING = (
    Quantity(
        "R14",
        "steering onset after a heading error of 1 deg, drivers' medians",
        "s",
        _LEEDS,
        _only(0.42),
        0.378,
        0.467,
        MEDIAN,
        _DESKTOP,
    ),
    Quantity(
        "R15",
        "steering onset after a heading error of 2 deg, drivers' medians",
        "s",
        _LEEDS,
        _only(0.37),
        0.345,
        0.417,
        MEDIAN,
        _DESKTOP,
    ),
    Quantity(
        "R16",
        "peak wheel angle after a heading error of 1 deg, drivers' medians",
        "deg",
        _LEEDS,
        _only(8.3),
        7.02,
        9.95,
        MEDIAN,
        _DESKTOP,
    ),
    Quantity(
        "R17",
        "peak wheel angle after a heading error of 2 deg, drivers' medians",
        "deg",
        _LEEDS,
        _only(13.3),
        11.76,
        15.43,
        MEDIAN,
        _DESKTOP,
    ),
)

_SPREADS = (
    ("lane position, standard deviation in 20 s", "m", 0.085, 0.290),
    ("lane position, correlation time (1/e) in 20 s", "s", 1.6, 3.1),
    ("lane position, drift between 0.1 and 0.5 Hz", "m", 0.049, 0.170),
)
_DRIFT = tuple(
    Quantity(
        f"R{18 + 2 * place + film}",
        quantity,
        unit,
        source,
        _UNKNOWN,
        low,
        high,
        MEDIAN,
        reason,
    )
    for place, (quantity, unit, low, high) in enumerate(_SPREADS)
    for film, (source, reason) in enumerate(((_R3, _ONE_CAR), (_FILMED, _FILM)))
)

_ROADS = (
    Quantity(
        "R24",
        "steering torque above 12 m/s, |torque|",
        "N·m",
        _UDACITY,
        _only(0.65),
        nan,
        nan,
        MEDIAN,
        _BENDS,
    ),
    Quantity(
        "R25",
        "steering reversals (3 deg, 0.6 Hz) above 12 m/s, each minute",
        "1/min",
        f"{_UDACITY}, comma2k19 (comma2k19_example)",
        _UNKNOWN,
        nan,
        nan,
        MEDIAN,
        _BENDS,
    ),
)

QUANTITIES: tuple[Quantity, ...] = _CHANGES + _GLANCES + _STEERING + _DRIFT + _ROADS
"""All that is compared, in the order of the report."""
