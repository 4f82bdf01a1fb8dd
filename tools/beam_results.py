#!/usr/bin/env python3
"""beam_results.py BENCH.json [--note TEXT]: docs/results/beam.json from what `palpable bench beam --json` printed.

tools/write_results.py makes a section of docs/results.md of it. The bench's own figures stay in the file.
"""
from bench_section import write_section


def methods_table(f):
    """The paper's Sec. 2.2: the result does not depend on the method."""
    d = f["against"]
    other = d["own_errors_of_it"]
    own = {"displacement_pooled": f["global"], "displacement_worst": f["worst_of_own_norm"],
           "stress_pooled": f["stress"]["pooled"], "stress_worst": f["stress"]["worst_of_own_norm"]}
    names = ("displacement_pooled", "displacement_median", "displacement_worst", "stress_pooled", "stress_median", "stress_worst")
    return {
        "heading": "By intrusive PGD and from a campaign", "folded": "Differences of the two bodies",
        "columns": ["", "displacement: pooled", "median", "worst", "stress: pooled", "median", "worst"],
        "rows": [
            [f"difference on the skin, {d['shared_sites']} shared positions at half and all of the load", *(d[n] for n in names)],
            ["stated by the campaign's body", *(other.get(n, "") for n in names)],
            ["stated by the intrusive body", *(own.get(n, "") for n in names)],
            ["target: twice the larger of the two", *("" if "median" in n else 2 * max(other[n], own[n]) for n in names)]]}


def section_of(f):
    modes, newton, stress, series = f["modes_at_1e-3"], f["newton"], f["stress"], f["series"]
    rows = [  # figure, measured, target, met
        ["modes at 1e-3, plain L2: raw / recompressed / SVD", f"{modes['raw']} / {modes['recompressed']} / {modes['svd']}",
         "1.3 / 1.05 times the SVD's, or one more",
         modes["raw"] <= max(1.3 * modes["svd"], modes["svd"] + 1) and modes["recompressed"] <= max(1.05 * modes["svd"], modes["svd"] + 1)],
        [f"worst position and load in its own norm, {f['modes_used']} modes", f["worst_of_own_norm"], "0.01 with 32 modes",
         f["worst_of_own_norm"] <= 0.01 and f["modes_used"] <= 32],
        [f"half of the positions left out, {f['heldout_modes']} modes: pooled", f["heldout_position_global"], "1e-3",
         f["heldout_position_global"] <= 1e-3],
        ["the worst of these in its own norm", f["heldout_position_worst"], "5e-3", f["heldout_position_worst"] <= 5e-3],
        ["the linear model, worst", f["linear_model_worst"], "above 0.01: it must fail", f["linear_model_worst"] > 0.01],
        [f"{newton['solves']} fresh Newton solves, seed {newton['seed']}: worst", newton["displacement_worst"], "0.01",
         newton["displacement_worst"] <= 0.01],
        [f"forces of the series against the load, worst position of {len(series['force_residual_at_loads'])} loads",
         series["force_residual"], "1e-6", series["force_residual"] <= 1e-6],
    ]
    if "two_load_error" in f:
        rows.append([f"two loads at once, {f['two_load_modes']} modes, {f['two_load_pairs']} fresh solves bent by up to "
                     f"{1e3 * f['two_load_largest_deflection_m']:.0f} mm: worst", f["two_load_error"], "0.03", f["two_load_error"] <= 0.03])
    rows += [["offline, CPU s of one core", f["offline_cpu_s"], "300", f["offline_cpu_s"] <= 300],
             ["online, displacement of the skin, us", f["online_us"], "100", f["online_us"] <= 100]]
    linear = [[name, figures["modes_at_1e-2"], figures["modes_at_1e-3"], figures["l2_with_16"], figures["energy_with_16"],
               figures["solves"]] for name, figures in f["linear"].items()]
    tables = [{"columns": ["figure", "measured", "target", "met"], "rows": rows},
              {"folded": "The linear beam", "columns": ["step in the position", "modes at 1e-2", "at 1e-3", "L2 error with 16",
                                                        "energy error with 16", "solves"], "rows": linear}]
    if "against" in f:
        tables.append(methods_table(f))
    return {
        "title": "The beam by intrusive PGD", "order": 70,
        "text": f"[beam.md](beam.md) describes the method. The body has {f['positions']} positions of a load and {f['nodes']} nodes; a load "
                f"bends it by up to {1e3 * newton['largest_deflection_m']:.0f} mm. Relative errors of the stress with {stress['modes']} "
                f"modes: {stress['pooled']:.2g} pooled, {stress['worst_of_own_norm']:.2g} at the worst position and load; against fresh "
                f"Newton solves median {newton['stress_median']:.2g}, worst {newton['stress_worst']:.2g}.",
        "command": ["palpable bake bodies/beam.toml -o build/bodies/beam.palpable",
                    "palpable bench beam --json --against build/bodies/beam.palpable > bench.json", "tools/beam_results.py bench.json", "tools/write_results.py"],
        "date": f["date"], "machine": f["processor"],
        "tables": tables}


if __name__ == "__main__":
    write_section(__doc__, "beam.json", section_of)
