"""Distinct products: one unit counts once, and what feeds it is said."""

from __future__ import annotations

from statistics import median

import pytest

from survey_data.products import Product, built_sensors, products


def test_an_accuracy_is_compared_as_an_rms() -> None:
    found = {
        key: built_sensors()[key].accuracy_rms_deg for key in ("C07", "C12", "C37", "C40", "C06")
    }
    assert found == pytest.approx(
        {"C07": 0.1, "C12": 0.2 / 3, "C37": 0.025 / 3, "C40": 10, "C06": None}
    )


def by_family() -> dict[str, Product]:
    return {product.family: product for product in products()}


def test_families_partition_the_rows_and_a_product_is_of_one_architecture() -> None:
    known = {key for key, one in built_sensors().items() if one.detector and one.mask}
    counted = [key for product in products() for key in product.ids]
    assert set(counted) == known
    assert len(counted) == len(known)
    assert list(by_family()) == sorted({built_sensors()[key].family for key in known})
    for product in products():
        rows = [built_sensors()[key] for key in product.ids]
        assert {(one.family, one.detector, one.mask) for one in rows} == {
            (product.family, product.detector, product.mask)
        }


def test_a_unit_that_stands_twice_counts_once() -> None:
    masses = {
        product.family: product.mass_g
        for product in products()
        if (product.detector, product.mask) == ("PD", "Maskless") and product.mass_g is not None
    }
    # The coarse sun sensor of Bradford is in the table twice: by row the median is 130 g.
    assert masses == {
        "adcole-cosine-cell": 10,
        "adcole-css-pyramid": 130,
        "bradford-coss": 10,
        "bradford-css": 215,
    }
    assert median(masses.values()) == 70
    mini = by_family()["bradford-mini-fss"]
    assert (mini.ids, mini.mass_g, mini.fov_full_deg) == (("C12", "C13"), 50, 128)
    assert mini.accuracy_rms_deg == pytest.approx(0.2 / 3)  # that of the row with a look-up table


def test_variants_of_a_model_and_rows_of_a_maker_and_a_paper_are_one_product() -> None:
    found = by_family()
    nano = found["solar-mems-nanossoc"]
    assert nano.names == ("Solar MEMS nanoSSOC-D60", "Solar MEMS nanoSSOC-A60")
    assert nano.power_mw == pytest.approx((76 + 10) / 2)
    assert nano.mass_g == pytest.approx((6.2 + 4) / 2)
    assert nano.update_hz == 5  # only one of the two rows states it
    rax = found["rax-photodiodes"]
    assert {built_sensors()[key].group for key in rax.ids} == {"commercial", "paper"}
    assert rax.studies == ("Springmann2014",)
    assert {"foresail-1-psd", "foresail-1p-dss"} <= set(found)


def test_a_sensor_on_its_own_solar_cells_is_no_passive_one() -> None:
    fed = {one.id for one in built_sensors().values() if one.supply == "self-powered"}
    assert fed == {"C42", "P09"}
    wireless = by_family()["tsinghua-wireless-profile"]
    assert (wireless.power_mw, wireless.supply) == (None, "self-powered")
    for product in products():
        assert (product.power_mw == 0) == (product.supply == "passive")


def test_a_sensor_on_its_own_cells_draws_no_power_and_others_draw_the_median() -> None:
    built = built_sensors()
    seen = set()
    for one in products():
        known = [built[key].power_mw for key in one.ids if built[key].power_mw is not None]
        own = one.supply == "self-powered"
        seen.add((own, bool(known)))
        assert one.power_mw == (None if own or not known else median(known))
    assert (False, True) in seen
