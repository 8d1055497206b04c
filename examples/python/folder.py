"""A folder of pairs, drawn from above with matplotlib: folder.py LEFT RIGHT CALIB OUT.png

LEFT and RIGHT are folders of images (or one image each). Every pair becomes a panel: what was found as bars of its
width, people as discs, the ground that was seen free in green.
"""
import math
import sys

import matplotlib.pyplot as plt

import flies


def draw(axes, found):
    # Plots have x to the right, the vehicle has y to the left.
    ground = found.scan.free_space()
    axes.fill(-ground[:, 1], ground[:, 0], color="tab:green", alpha=0.2, label="seen free")
    for obstacle in found.obstacles:
        bearing = math.atan2(obstacle.y_m, obstacle.x_m)
        across = (-math.sin(bearing), math.cos(bearing))  # to the left, across the line of sight
        ends = [obstacle.middle_offset_m + side * obstacle.width_m / 2 for side in (-1, 1)]
        axes.plot(
            [-(obstacle.y_m + across[1] * end) for end in ends],
            [obstacle.x_m + across[0] * end for end in ends],
            color="tab:red",
            linewidth=3,
        )
    people = found.pedestrian_array
    axes.scatter(-people["y_m"], people["x_m"], color="tab:purple", zorder=3, label="people")
    axes.set(xlim=(-12, 12), ylim=(0, 40), aspect="equal", xlabel="to the right [m]", ylabel="ahead [m]")


def main(left, right, calib, out):
    pairs = flies.find_pairs(left, right)
    calibration = flies.load_calibration(calib, images=flies.load_pair(*pairs[0]))
    detector = flies.Detector(calibration.camera)
    _, panels = plt.subplots(1, len(pairs), figsize=(4 * len(pairs), 6), squeeze=False, layout="constrained")
    for axes, paths in zip(panels[0], pairs):
        found = detector.process(*calibration.rectify(*flies.load_pair(*paths)))
        print(f"{paths[0]}: {len(found.obstacles)} obstacles, {len(found.pedestrians)} people")
        draw(axes, found)
    panels[0][0].legend(loc="lower left")
    plt.savefig(out)


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except flies.InputError as error:
        sys.exit(f"folder.py: {error}")
