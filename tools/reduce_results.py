#!/usr/bin/env python3
"""reduce_results.py BENCH.json [--note TEXT]: docs/results/reduce.json from what `palpable bench reduce --json` printed.

tools/write_results.py makes a section of docs/results.md of it. The bench's own figures stay in the file.
"""
from bench_section import write_section

METHODS = [("pod", "POD"), ("pgd2", "PGD, two factors"), ("pgd3", "PGD, three factors"), ("cp", "CP-ALS"),
           ("hosvd", "ST-HOSVD"), ("per_site", "blocks per site")]


def megabytes(count):
    return f"{count / 1e6:.1f} MB"


def section_of(figures):
    rows = []
    for key, name in METHODS:
        def cells(prefix):
            modes = figures[prefix + "modes_at_1e-3"][key]
            if key == "per_site":
                modes = f"{modes} at most, {figures[prefix + 'per_site_modes_in_all_at_1e-3']} in all"
            elif key == "hosvd":
                modes = " x ".join(map(str, figures[prefix + "hosvd_ranks"]))
            return [modes, megabytes(figures[prefix + "bytes_at_1e-3"][key]),
                    figures[prefix + "worst_snapshot_at_1e-3"][key]]
        rows.append([name] + cells("") + cells("stress_"))
    default, pgd3 = figures["default"], figures["pgd3"]
    held_out = [[name, f"{form['displacement']['modes']} / {form['stress']['modes']}",
                 megabytes(form["displacement"]["bytes"] + form["stress"]["bytes"]),
                 figures[prefix + "heldout_u_pooled"], figures[prefix + "heldout_u_median"],
                 figures[prefix + "heldout_u_worst"], figures[prefix + "heldout_vm_median"],
                 figures[prefix + "heldout_vm_worst"]]
                for name, form, prefix in [("default: per site, 1e-4, own norms", default, ""),
                                           ("the paper's: PGD, 1e-3", pgd3, "pgd3_")]]
    recomputed = figures["recomputed_stress"]
    return {
        "title": "Reductions of the bunny's campaign", "order": 60,
        "text": "Modes and bytes that each method ([reduction.md](reduction.md)) needs for a relative L2 error of 1e-3 over the volume. Blocks "
                "per site meet it at every site, the others pooled. Bytes: skin, single precision, functions of the parameters included. "
                "Worst: the worst snapshot in its own norm.\n\n"
                f"Sparse PGD, trained on {figures['sparse_trained_on']} of the beam's {figures['sparse_samples']} snapshots, has "
                f"{figures['sparse_modes']} modes. On the others its error is {figures['sparse_heldout']:.2g} pooled, median "
                f"{figures['sparse_heldout_median']:.2g}, worst {figures['sparse_heldout_worst']:.2g}.",
        "command": ["palpable bench reduce --json > bench.json", "tools/reduce_results.py bench.json",
                    "tools/write_results.py"],
        "date": figures["date"], "machine": figures["processor"],
        "tables": [
            {"columns": ["method", "modes", "bytes", "worst", "stress: modes", "bytes", "worst"], "rows": rows},
            {"heading": "At levels between the snapshots", "folded": "Errors at (m + 1/2)/26 of the full press, solved afresh",
             "text": "On the skin. Displacement against each snapshot's own norm; von Mises stress: worst vertex against the field's own "
                     "maximum.",
             "columns": ["body", "modes u / stress", "bytes", "u pooled", "u median", "u worst", "von Mises median",
                         "von Mises worst"],
             "rows": held_out},
            {"heading": "A touch between sites", "folded": "Errors of the nearest site's field",
             "text": "Relative L2 error over the skin of the nearest site's field against the touch's own response at the same depth; "
                     "linear responses.",
             "columns": ["sites", "touches", "median", "90th percentile", "worst"],
             "rows": [[row["sites"], row["touches"], row["median"], row["nine_tenths"], row["worst"]]
                      for row in figures["between_sites"]]},
            {"heading": "Stress: a field of its own, or recomputed", "folded": "Errors, bytes and microseconds",
             "text": f"Von Mises stress on the skin at levels between, every fourth site and fifth level: worst vertex against the field's "
                     f"own maximum. Recomputed: from modes of displacement of {recomputed['outer_nodes']} nodes, over "
                     f"{recomputed['outer_tets']} elements, which are all that the skin's stress depends on. Bytes: displacement and "
                     "stress of the whole body. Microseconds: both, one core.",
             "columns": ["stress", "median", "worst", "bytes", "us"],
             "rows": [[row["stress"], row["vm_median"], row["vm_worst"], megabytes(row["bytes"]), row["us"]]
                      for row in recomputed["rows"]]}]}


if __name__ == "__main__":
    write_section(__doc__, "reduce.json", section_of)
