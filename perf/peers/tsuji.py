"""LAMMPS' damping of Tsuji, `damping tsuji` of pair style granular."""
import math


def restitution_given(restitution):
    """The coefficient to write so that spheres part with this restitution. LAMMPS puts the polynomial that Tsuji et
    al. (1992) fitted with the mass of a sphere before the reduced mass: 0.6 written becomes 0.70. Exact is -sqrt(5)
    ln e / sqrt(ln^2 e + pi^2) (Antypov and Elliott 2011). Below 0.13 no coefficient damps enough."""
    def fitted(e):
        return 1.2728 - 4.2783 * e + 11.087 * e**2 - 22.348 * e**3 + 27.467 * e**4 - 18.022 * e**5 + 4.8218 * e**6

    if restitution >= 1:
        return 1.0
    fall = math.log(max(restitution, 1e-9))
    wanted, low, high = -math.sqrt(5) * fall / math.hypot(fall, math.pi), 0.0, 1.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if fitted(middle) > wanted else (low, middle)
    return low
