"""Corrections of the source with reasons; `python -m docs.make_errata` writes `docs/explanation/errata.md` from it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Erratum:
    """A correction of the source.

    Attributes:
        title: what is corrected.
        text: what is printed, what is right, and why; Markdown, paragraphs and tables with an empty line between.
        shown_by: ids of the statements whose numbers show it.
    """

    title: str
    text: str
    shown_by: tuple[str, ...] = ()


ERRATA: dict[str, tuple[Erratum, ...]] = {
    "Dynamics": (
        Erratum(
            "Kinetic energy (3.14)",
            "The printed sum has the energies of the rotors, of the boom, and of two links that turn about fixed "
            "axes. It lacks the translation of thigh and shank with the boom, and the coupling of the two links. "
            "The printed energy of the shank uses the relative rate θ̇₂ instead of the absolute rate θ̇₁ - θ̇₂. "
            "The correct energy of each link is ½ m |ẋ_c|² + ½ J ω², with the velocity of its centre of mass and "
            "its absolute rate (see [the model](model.md)). In the push test a leg is pushed down and released. "
            "The toe stays on the ground below the hip, so the leg has one degree of freedom. The knee's "
            "effective inertia Sᵀ D S, S = dq/dθ₂, is then 0.1932 kg·m² at a knee angle of 1.0 rad. The printed "
            "form gives 15 % less, 0.1636 kg·m².",
            ("kinetic-energy",),
        ),
        Erratum(
            "Potential energy (3.15)",
            "The printed form counts heights from the toe, so it is wrong in flight. It has l₂ instead of l₂ - "
            "d₂ in the shank's term, and the sum θ₁ + θ₂ instead of the difference, which (3.20) has. With y the "
            "height of the hip, the correct form is V = M g y + m₁ g (y - d₁ cos θ₁) + m₂ g (y - l₁ cos θ₁ - d₂ "
            "cos(θ₂ - θ₁)). In the push test at 1.0 rad, gravity flexes the knee with 9.62 N·m; the printed form "
            "gives 18.40 N·m.",
            ("potential-energy",),
        ),
        Erratum(
            "Rotor inertias (3.12)-(3.13)",
            'These equations multiply the rotor inertia by N². But the "motor inertias" of Tables 2.4 and 5.1 '
            "are already multiplied; Table 5.1 calls them effective. Divided by N² they are 0.027 kg·m² / 15² = "
            "1200 g·cm² and 0.047 kg·m² / 60² = 131 g·cm², usual for such motors. The URDF has the rotor's own "
            "inertia and the ratio. Table 3.1 exchanges the descriptions of N_Knee and N_Hip, and the unit of "
            "rotor angles should be rad.",
            (
                "rotor-energy",
                "knee-rotor-spear-ii",
                "hip-rotor-spear-ii",
                "bare-knee-rotor",
                "table-3.1-ratios",
            ),
        ),
        Erratum(
            "Rotor of the knee (3.13)",
            "The motor's stator turns with the thigh. So the rotor has the energy ½ J (s θ̇₁ - N θ̇₂)², where s "
            "= ±1 is the rotor's sense of turning. The coupling term N J is 0.0018 kg·m², small against the "
            "hip-knee entry of the mass matrix, 0.026 kg·m². The thesis neglects this coupling and does not say "
            "which sense is right, so we neglect it too (s = 0).",
            ("stator-turns",),
        ),
        Erratum(
            "Shank inertia",
            "Table 2.4 has 0.014 kg·m², Table 5.1 has 0.005. They agree if the first is about the knee: 0.005 + "
            "0.48 × 0.14² = 0.0144. Table 3.1 defines J₂ about the centre of mass, so here J₂ = 0.005 and m₂d₂² "
            "is added once.",
            (
                "shank-inertia-about-knee",
                "shank-inertia-about-com",
            ),
        ),
        Erratum(
            "Mass of the shank",
            "Table 2.4 has 0.48 kg at 0.14 m, Table 5.1 has 0.47 kg at 0.144 m. SPEAR-II uses the first, Q-SPEAR "
            'the second. The unit "kg/m²" of inertias in Table 5.1 should be kg·m².',
            ("same-shank",),
        ),
        Erratum(
            "Friction (3.16), (3.18)",
            "F_x = μ F_y has no direction. Friction opposes sliding: F_x = -μ F_y sign(ẋ_toe), with F_y ≥ 0.",
            ("sliding-friction",),
        ),
        Erratum(
            "Inputs (3.22)-(3.23)",
            "The printed equations add hip and knee torques as scalars. Here τ = (τ_hip, τ_knee + τ_spring + "
            "τ_damping). Since θ₂ is a relative angle, each torque acts on one coordinate only.",
            ("scalar-input",),
        ),
        Erratum(
            "Spring (3.24)",
            "On the coordinate θ₂, the printed τ = +k (θ₂ - θ₂ᵗᵈ) pushes away from the rest angle. With torques "
            "counted positive in extension this sign is correct, but then (3.25), -b θ̇₂, drives instead of "
            "damping. Here the torque is -k (θ₂ - θ₂ᵗᵈ), and zero below θ₂ᵗᵈ, because the spring acts through a "
            "chain that only pulls.",
            ("spring-sign",),
        ),
    ),
    "Control": (
        Erratum(
            "Flight law (4.9)-(4.10)",
            "With K > 0 the printed term K (θ - θ_des) pushes away from the commanded angle. The printed K_D < 0 does "
            "damp, as the thesis says. With the printed signs the poles in flight are 15.07, -23.80, 35.15 and -51.15 "
            "rad/s, which is unstable. Here τ = K (θ_des - θ) - |K_D| θ̇.",
            ("flight-law-sign",),
        ),
        Erratum(
            "Stance law (4.10)",
            "The thesis describes a flexing torque that helps to compress the spring in the first half of "
            "stance, and an extending torque that pushes off in the second. In terms of θ₂, positive in flexion, "
            "this law is +τ̄ sign(sin(2πf(t - t_td))). The printed minus is the same law for torques counted "
            "positive in extension. One period 1/f after touchdown this square wave flexes the knee again and so "
            "ends a stance that lasts so long. With `hold_extension` the torque goes on extending instead.",
            ("half-waves",),
        ),
        Erratum(
            "Gains",
            "With the printed gains and corrected signs, the poles of the leg in flight are -4.40 ± 18.52j and "
            "-7.97 ± 41.42j rad/s. Their damping ratios are 0.23 and 0.19. So in 0.2 s these gains do not bring "
            "the joints to rest, though the thesis says that they do. The thesis neglects the knee's damping in "
            "flight; 1.3 N·m·s/rad there would raise the knee's damping ratio to 0.61. "
            "[Hopping](../how_to/hop.md) has the rates at touchdown, and gains that bring the joints to rest.",
            (
                "settles-in-flight",
                "knee-flat-before-touchdown",
                "damping-in-flight",
                "gains-by-classical-tuning",
            ),
        ),
    ),
    "Table 4.2": (
        Erratum(
            "Averages",
            'The row "with motor" is not the mean of Table 4.1\'s rows:\n\n'
            "| | k_rot, N·m/rad | b, N·m·s/rad | RA, rad | σ_k | σ_b | σ_RA | fit |\n"
            "| --- | --- | --- | --- | --- | --- | --- | --- |\n"
            "| printed, with motor | 48.84 | 1.3 | 1 | 6.19 | 0.5 | 0.03 | 84.62 % |\n"
            "| mean of Table 4.1 | 51.35 | 1.31 | 1.01 | 6.41 | 0.50 | 0.03 | 86.20 % |\n"
            "| printed, no motor | 47.99 | 1.04 | 1 | 5.47 | 0.41 | 0.03 | 87.62 % |\n"
            "| mean of Table 4.1 | 47.99 | 1.04 | 1.00 | 5.47 | 0.41 | 0.03 | 87.63 % |\n\n"
            "The default here is the printed row with motor. [Hopping](../how_to/hop.md) shows what 51.35 "
            "changes.",
            (
                "mean-stiffness-with-motor",
                "mean-fit-with-motor",
                "motor-stiffens",
            ),
        ),
    ),
    "The push test": (
        Erratum(
            "Resting angle RA",
            "RA may be the spring's zero, or the angle at which the leg rests under gravity. The two differ by "
            "the gravity torque over k, about 0.2 rad. The ratios of the standard deviations in Table 4.1 favour "
            "the first reading ([the push test](../how_to/identify_a_knee.md)).",
            ("resting-angle",),
        ),
        Erratum(
            "Friction",
            "Section 4.1.5.1 speaks of Coulomb friction, but the model has a viscous one. In Table 4.1, b "
            "decreases as the push gets deeper, with and without the motor: the effect of dry friction on a "
            "viscous fit. The identification here can also fit dry friction, τ_c.",
            ("viscous-friction",),
        ),
        Erratum(
            "Pinned toe (Section 4.1.2)",
            "The model holds the toe to the ground. Take the estimates of Table 4.1, with RA as the spring's "
            "zero. In the release from 10 cm without the motor, the ground would then have to pull the toe down "
            "with 11.5 N. So a free toe would lift off for a moment. In the other five rows it stays down.",
            ("toe-stays-down",),
        ),
        Erratum(
            "Moving average",
            "The thesis smooths the data over 100 samples, and does not say whether it smooths the model too. On "
            "synthetic records with only the data smoothed, a centred average raises b by 9 % and does not "
            "change k. A causal average lowers k by 22 % and raises b by 12 %. Here both are smoothed.",
        ),
        Erratum(
            "Belt (4.5)-(4.7)",
            "The cross-section of the belt is 1.242·10⁻⁵ m²; its printed unit is wrong. The thesis puts the belt "
            "in parallel to the spring, as if the rotor stood still. Without current the rotor turns, and the "
            "belt lies between rotor and knee. The modulus of neoprene leaves out the belt's cords. A belt as "
            "soft as 0.73 to 1.09 N·m/rad would decouple the rotor, instead of delaying the swing as in Fig. "
            "4.5. In Table 4.2 the stiffnesses with and without motor differ by 0.85 N·m/rad. This lies in the "
            "belt's range by coincidence: with the means of Table 4.1 the difference is 3.4 N·m/rad.",
            (
                "belt-stiffness",
                "belt-explains-motor",
                "motor-stiffens-distinctly",
            ),
        ),
        Erratum(
            "Back-EMF (4.8)",
            "The printed 34.5 V belong to 20 rad/s of the joint: 0.115 × 15 × 20. The text speaks of a rotor at "
            "20 rad/s, which would give 2.3 V. On the battery of 24 V the knee can be driven up to 13.9 rad/s. "
            "Above 14.7 rad/s the diodes of a bridge conduct, even if all its switches are open. In the push "
            "test the knee stays far below this speed.",
            ("back-emf", "back-emf-of-rotor", "speed-on-24-volts", "open-is-no-load", "swing-below-threshold"),
        ),
        Erratum(
            "Shorted phases",
            "With the assumed 1.1 Ω, shorted phases would brake the knee by 2.7 N·m·s/rad. The motor raises b by "
            "only 0.26 N·m·s/rad, so its circuit was open, as the thesis concludes.",
            ("open-circuit",),
        ),
    ),
    "The quadruped": (
        Erratum(
            "Stance law (5.5)-(5.6)",
            "With the printed knee angles, θ̄_p = +40° and θ̄_a = -40°, the printed spring torque +k (θ - θ̄) "
            "increases flexion; -k (θ - θ̄) resists it. The torque ū that presses the foot down extends the "
            "knee: ū_p < 0, ū_a > 0. Here τ = -side (|ū| + k (side θ - |θ̄|)), with side = +1 for the posterior "
            "and -1 for the anterior knee.",
            ("bounding-knee-sign",),
        ),
        Erratum(
            "Output linearisation",
            "The last term of (5.15) and (5.20) is L²_f h; the thesis prints L_g L_f h again. The text below (5.10) "
            "means the outputs (5.9); their H should have the index of the phase. The text before (5.22) should say "
            "that x⁺ is *not* in Z. In (5.10) γ^td is the value at touchdown, and Δ is negative because the leg sweeps "
            "back. The sentence under (5.3) exchanges g^sw and g^su. The state (q_s′, q̇_s′)′ is x_s, without a dot.",
            ("output-linearisation",),
        ),
        Erratum(
            "Pairs",
            "The total of 43.76 kg in Table 5.1 is a torso of 35 kg with four legs. So a leg of the sagittal "
            "model is a pair of legs, with twice the mass, inertia, spring and torque. In Fig. 5.6 the motor's "
            "torque is constant at k_rot = 200 N·m/rad. So k_p = k_a is 200 N·m/rad for one motor, and 400 for a "
            "pair. At k_rot = 300 and 400 the spring gives more than the law asks for, and the motor works "
            "against the spring. Where ū is small, the motor's torque is reversed.",
            (
                "total-mass",
                "flat-at-200",
                "stiffer-than-200",
            ),
        ),
        Erratum(
            "120:1 at the hip",
            "Doubling the ratio multiplies the reflected inertia by four, from 0.047 to 0.188 kg·m². The "
            "straight leg's inertia about the hip is 0.014 + 1.72 · 0.008² + 0.005 + 0.47 · 0.462² = 0.119 "
            'kg·m². So the rotor has 1.6 times the inertia of the leg. The thesis calls this "not as much a '
            "concern\" as at the knee, where the rotor's 0.027 kg·m² are 1.8 times the shank's 0.015. But the "
            "rotor inertia at the hip is seven times that at the knee. The thesis also calls the hip's effort "
            '"relatively small" and says that its motor "would not be able to provide the peak torques". These '
            "two statements contradict each other.",
            (
                "hip-inertia-no-concern",
                "hip-effort-small",
                "hip-drive-exceeded",
                "doubled-hip-gears",
            ),
        ),
        Erratum(
            'A larger knee motor "with similar mass and inertia"',
            "The motor may be the EC 90 flat. Its rotor has 5060 g·cm², 4.2 times the 1210 g·cm² of the EC 60 "
            "flat. Reflected to the knee that is 0.114 instead of 0.027 kg·m².",
            ("similar-260-w",),
        ),
    ),
}
