"""Corrections of the source, and why; `docs/explanation/errata.md` is written from this by `python -m docs.make_errata`."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Erratum:
    """A correction.

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
            "It adds the energies of the rotors, of the boom, and of two links that turn about fixed axes. "
            "The translation of thigh and shank with the boom, and the coupling of the two links, are "
            "missing, and the shank turns with the relative rate θ̇₂ where its absolute rate θ̇₁ - θ̇₂ "
            "belongs. Right is, for each link, ½ m |ẋ_c|² + ½ J ω² with the velocity of its centre of mass "
            "and its absolute rate; see [model.md](model.md). In the push test (toe on the ground below the "
            "hip, one degree of freedom), the knee's effective inertia Sᵀ D S, S = dq/dθ₂, is 0.1932 kg·m² at "
            "1.0 rad; the printed form gives 0.1636, 15 % less.",
            ("kinetic-energy",),
        ),
        Erratum(
            "Potential energy (3.15)",
            "The height of a centre of mass is counted from the toe, and its terms do not reach the right "
            "places: with y the height of the hip, V = M g y + m₁ g (y - d₁ cos θ₁) + m₂ g (y - l₁ cos θ₁ - "
            "d₂ cos(θ₂ - θ₁)). The printed form has l₂ where l₂ - d₂ belongs in the shank's term, the angle "
            "sum θ₁ + θ₂ where the difference belongs (as in (3.20)), and, counting from the toe, is wrong in "
            "flight. In the push test at 1.0 rad, gravity flexes the knee with 9.62 N·m; the printed form "
            "gives 18.40.",
            ("potential-energy",),
        ),
        Erratum(
            "Rotor inertias (3.12)-(3.13)",
            'These multiply the rotor inertia by N². The "motor inertias" of Tables 2.4 and 5.1 are already '
            "multiplied (Table 5.1 calls them effective): 0.027 kg·m² / 15² = 1200 g·cm² and 0.047 / 60² = "
            "131 g·cm², sizes that such motors have, while 15² × 0.027 = 6 kg·m² would be absurd. The URDF "
            "carries the rotor's own inertia and the ratio. In Table 3.1 the descriptions of N_Knee and N_Hip "
            "are exchanged, and the unit of rotor angles should be rad.",
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
            "The motor's stator turns with the thigh, so that its rotor has ½ J (s θ̇₁ - N θ̇₂)², s = ±1 by the "
            "sense in "
            "which it turns. The term N J that couples hip and knee is 0.0018 kg·m², against 0.026 in the mass "
            "matrix. The "
            "sense is not given; here s = 0, as in the source.",
            ("stator-turns",),
        ),
        Erratum(
            "Shank inertia",
            "Table 2.4 has 0.014 kg·m², Table 5.1 has 0.005. They agree if the first is about the knee: 0.005 "
            "+ 0.48 × 0.14² = 0.0144. Table 3.1 defines J₂ about the centre of mass, so here J₂ = 0.005 and "
            "m₂d₂² is added once.",
            (
                "shank-inertia-about-knee",
                "shank-inertia-about-com",
            ),
        ),
        Erratum(
            "Mass of the shank",
            "Table 2.4 has 0.48 kg at 0.14 m, Table 5.1 0.47 kg at 0.144 m. SPEAR-II uses the first, Q-SPEAR "
            'the second. Units "kg/m²" of inertias in Table 5.1 are kg·m².',
            ("same-shank",),
        ),
        Erratum(
            "Friction (3.16), (3.18)",
            "F_x = μ F_y has no direction. Friction opposes sliding, F_x = -μ F_y sign ẋ_toe, with F_y ≥ 0.",
            ("sliding-friction",),
        ),
        Erratum(
            "Inputs (3.22)-(3.23)",
            "They add hip and knee torques as scalars. Here τ = (τ_hip, τ_knee + τ_spring + τ_damping), and "
            "since θ₂ is relative, each enters one row.",
            ("scalar-input",),
        ),
        Erratum(
            "Spring (3.24)",
            "τ = +k (θ₂ - θ₂ᵗᵈ) pushes away from its rest angle wherever the coordinate is θ₂. It would be "
            "right with torques counted positive in extension, but then (3.25), -b θ̇₂, would drive instead "
            "of damp. Here -k (θ₂ - θ₂ᵗᵈ), and zero below the latched angle: the spring acts through a chain, "
            "which pulls only.",
            ("spring-sign",),
        ),
    ),
    "Control": (
        Erratum(
            "Flight law (4.9)-(4.10)",
            "With K > 0 the term K (θ - θ_des) pushes away from the commanded angle; the printed K_D < 0 does "
            "damp, as the source says. With the printed signs the poles in flight are 15.07, -23.80, 35.15 "
            "and -51.15 rad/s: unstable. Here τ = K (θ_des - θ) - |K_D| θ̇.",
            ("flight-law-sign",),
        ),
        Erratum(
            "Stance law (4.10)",
            "A flexing torque helps to compress the spring in the first half of stance, an extending one "
            "pushes off in the second; that is what the source describes. On θ₂, positive in flexion, this is "
            "+τ̄ sign sin 2πf(t - t_td). The printed minus is the same law for torques counted positive in "
            "extension. After t = 1/f the wave flexes again and ends stance, if it has not ended before; "
            "`hold_extension` is the alternative.",
            ("half-waves",),
        ),
        Erratum(
            "Gains",
            "With the printed gains and corrected signs the poles of the leg in flight are -4.40 ± 18.52j and "
            "-7.97 ± 41.42j rad/s, damping ratios of 0.23 and 0.19: in 0.2 s they do not bring the joints to "
            "rest, as the source says they do. Damping of 1.3 N·m·s/rad at the knee in flight too, which the "
            "source calls negligible there, would raise the knee's ratio to 0.61. [hopping.md](../how_to/hop.md) "
            "has the rates at touchdown, and gains that do bring the joints to rest.",
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
            'The row "with motor" is not the mean of Table 4.1\'s:\n\n'
            "| | k_rot | b | RA | σ_k | σ_b | σ_RA | fit |\n"
            "| --- | --- | --- | --- | --- | --- | --- | --- |\n"
            "| printed, with motor | 48.84 | 1.3 | 1 | 6.19 | 0.5 | 0.03 | 84.62 % |\n"
            "| mean of Table 4.1 | 51.35 | 1.31 | 1.01 | 6.41 | 0.50 | 0.03 | 86.20 % |\n"
            "| printed, no motor | 47.99 | 1.04 | 1 | 5.47 | 0.41 | 0.03 | 87.62 % |\n"
            "| mean of Table 4.1 | 47.99 | 1.04 | 1.00 | 5.47 | 0.41 | 0.03 | 87.63 % |\n\n"
            "The default here is the printed 48.84 N·m/rad and 1.3 N·m·s/rad; either stiffness lies well "
            "within one standard deviation of the other. What 51.35 changes is in [hopping.md](../how_to/hop.md).",
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
            "It may be the spring's zero or the angle at which the leg stands; they differ by G/k, about 0.2 "
            "rad. The ratios of the standard deviations in Table 4.1 favour the first reading "
            "([push_test.md](../how_to/identify_a_knee.md)).",
            ("resting-angle",),
        ),
        Erratum(
            "Friction",
            "Section 4.1.5.1 speaks of Coulomb friction and the model has a viscous one. That b falls with "
            "the depth in Table 4.1, with motor and without, is what dry friction does to a viscous fit. Dry "
            "friction is offered as τ_c.",
            ("viscous-friction",),
        ),
        Erratum(
            "Pinned toe (Section 4.1.2)",
            "The model holds the toe to the ground. With the estimates of Table 4.1, RA being the spring's zero, the "
            "release without motor from 10 cm would need the ground to pull by 11.5 N: a free toe would lift off for a "
            "moment. In the other five sets it stays down.",
            ("toe-stays-down",),
        ),
        Erratum(
            "Moving average",
            "The data are smoothed over 100 samples; that the model is, too, is not said. If it is not, a centred "
            "average raises b by 9 % and leaves k, and a causal one lowers k by 22 % and raises b by 12 %, in "
            "synthetic records. Here both are smoothed.",
        ),
        Erratum(
            "Belt (4.5)-(4.7)",
            "The area is 1.242·10⁻⁵ m². A belt in parallel to the spring presumes a rotor that stands still; "
            "with no current it floats, and the belt lies in series. The modulus of neoprene leaves out the "
            "belt's cords: a belt as soft as 0.73 to 1.09 N·m/rad would decouple the rotor instead of "
            "delaying the swing. That the difference of Table 4.2 lies in that range is a coincidence: with "
            "the rows' own mean it is 3.4 N·m/rad, and either is below one standard deviation.",
            (
                "belt-stiffness",
                "belt-explains-motor",
                "motor-stiffens-distinctly",
            ),
        ),
        Erratum(
            "Back-EMF (4.8)",
            "34.5 V are those at 20 rad/s of the joint, 0.115 × 15 × 20; of a rotor that spins at 20 rad/s, as the "
            "sentence has it, they would be 2.3 V. On the battery of 24 V the knee can be driven up to 13.9 rad/s, and "
            "above 14.7 the diodes of a bridge whose switches are all open conduct: it then is a generator with a "
            "load. "
            "In the push test the back-EMF stays far below.",
            ("back-emf", "back-emf-of-rotor", "speed-on-24-volts", "open-is-no-load", "swing-below-threshold"),
        ),
        Erratum(
            "Shorted phases",
            "With the 1.1 Ω assumed they would brake the knee by 2.7 N·m·s/rad; b rises by 0.26 with the motor, so its "
            "circuit was open, as the source concludes.",
            ("open-circuit",),
        ),
    ),
    "The quadruped": (
        Erratum(
            "Stance law (5.5)-(5.6)",
            "On knee angles positive as printed, θ̄_p = +40° and θ̄_a = -40°, a spring that resists flexion "
            "is -k (θ - θ̄), and the torque that keeps the foot pressed down extends: ū_p < 0, ū_a > 0. Here "
            "τ = -side (|ū| + k (side θ - θ̄)), with side = +1 for the posterior and -1 for the anterior "
            "knee.",
            ("bounding-knee-sign",),
        ),
        Erratum(
            "Output linearisation",
            "The last term of (5.15) and (5.20) is L²_f h, not L_g L_f h again; "
            "the outputs meant below (5.10) are (5.9), whose H has the index of its phase; the lead-in of "
            "(5.22) has to say that x⁺ is *not* in Z. In (5.10) γ^td is the value at touchdown and Δ is "
            "negative, for the leg sweeps back. In the sentence under (5.3) g^sw and g^su are exchanged, and "
            "the state (q_s′, q̇_s′)′ is x_s, without a dot.",
            ("output-linearisation",),
        ),
        Erratum(
            "Pairs",
            "The total of 43.76 kg in Table 5.1 is 35 kg with four legs, so that a leg of the sagittal model "
            "is a pair, with twice the mass, inertia, spring and torque. Fig. 5.6, where the motor's curve is "
            "flat at k_rot = 200 N·m/rad, then says that k_p = k_a is 200 N·m/rad a motor, 400 a pair. At 300 "
            "and 400 the spring does more than the law asks for, and the motor has to take off the excess: where "
            "ū is small, its torque is reversed.",
            (
                "total-mass",
                "flat-at-200",
                "stiffer-than-200",
            ),
        ),
        Erratum(
            "120:1 at the hip",
            "Doubling the ratio reflects four times 0.047 = 0.188 kg·m². The straight leg's inertia about the "
            "hip is 0.014 + 1.72 · 0.008² + 0.005 + 0.47 · 0.462² = 0.119 kg·m²: the rotor outweighs the leg "
            'it moves, 1.6 to 1. That this is "not as much a concern" as at the knee depends on the measure: there '
            "0.027 kg·m² move a shank of 0.015 about the knee, 1.8 to 1, but in kg·m² the hip's is seven times as "
            "much. "
            'That the hip\'s effort is "relatively small" and that its motor "would not be able to provide the peak '
            'torques" do not go together.',
            (
                "hip-inertia-no-concern",
                "hip-effort-small",
                "hip-drive-exceeded",
                "doubled-hip-gears",
            ),
        ),
        Erratum(
            'A larger knee motor "with similar mass and inertia"',
            "If it is the EC 90 flat, its rotor has 5060 g·cm² against 1210: 4.2 times, or 0.114 instead of "
            "0.027 kg·m² at the knee.",
            ("similar-260-w",),
        ),
    ),
}
