"""Success, collision and timeout rates of ORCA and RVO, with the same seeds and the same horizon."""

import irsim

if __name__ == "__main__":
    result = irsim.benchmark(
        ["sparse.yaml", "medium.yaml", "dense.yaml"], behaviors=["orca", "{name: rvo, vxmax: 1, vymax: 1}"],
        seeds=$(episodes), steps=$(steps),
    )
    for row in result.rows:
        rates = {"success": row.success, "collision": row.collision, "timeout": row.timeout}
        print(row.scenario, row.behavior, *(f"{name} {share.rate:.0%}" for name, share in rates.items()))
