"""Tables of the population: parameters, and what goes together."""

from __future__ import annotations

from costeer.drivers.traits import FACTORS
from costeer.pages.numerals import signed
from costeer.pages.tables import Table
from costeer.validation.drawn import distribution_told, spreads
from costeer.validation.drawn_figure import Drawn, spoken
from costeer.validation.reporting.target_tables import wrapped
from costeer.validation.reporting.words import short


def parameters_table(drawn: Drawn) -> Table:
    """Return what differs between drivers, with its distribution."""
    return Table(
        name="parameters",
        title="What differs between the drivers",
        note="The number of a distribution is the standard deviation, of the "
        "logarithm if it is log-normal; some are clipped. Percentiles over these "
        "drivers, SI units. All other parameters are the "
        "same for all drivers; docs/drivers.md has them with their sources.",
        header=("Parameter", "Unit", "Distribution", "5 %", "Median", "95 %"),
        rows=tuple(
            (
                spoken(each.parameter).replace(".", ": "),
                "–" if each.unit == "-" else each.unit,
                distribution_told(each.parameter, drawn.population),
                *(short(value) for value in (each.low, each.median, each.high)),
            )
            for each in spreads(drawn.drivers)
        ),
        num_labels=3,
    )


def factors_table() -> Table:
    """Return the factors behind the traits and where they are from."""
    return Table(
        name="factors",
        title="What goes together",
        note="Two traits of a factor are correlated by the product of their loadings; "
        "traits without a common factor are independent.",
        header=("Factor", "Loadings", "Source"),
        rows=tuple(
            (
                factor.name,
                wrapped(
                    ", ".join(
                        f"{spoken(name)} {signed(loading, 2)}"
                        for name, loading in factor.loadings.items()
                    ),
                    54,
                ),
                wrapped(factor.source, 54),
            )
            for factor in FACTORS
        ),
        num_labels=3,
    )
