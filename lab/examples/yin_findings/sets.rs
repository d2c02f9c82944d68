//! Rigs at random, always the same ones: a fixed generator draws belts, masses and friction within the ranges of a
//! group.

use corehbot_lab::yin::{Model, NOMINAL, Parameters, axes};

/// A kind of machine.
pub struct Group {
    /// What it is called in the table.
    pub name: &'static str,
    /// Tensile stiffness E A of the belt, N.
    pub belt: [f64; 2],
    /// Length of a belt section, m.
    pub section: [f64; 2],
    /// End-effector and y-frame, kg.
    pub mass: [f64; 2],
    /// Damping ratio of each axis.
    pub damping: [f64; 2],
}

/// Steele, Lea and Flood, "Fast splittable pseudorandom number generators" (2014): SplitMix64.
pub struct Generator(pub u64);

impl Generator {
    /// Evenly in 0 to 1.
    fn part(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Evenly in the logarithm.
    fn within(&mut self, [low, high]: [f64; 2]) -> f64 {
        low * (high / low).powf(self.part())
    }
}

/// Draws until the friction of the idlers is less than the damping drawn for each axis: the guides have the rest.
pub fn draw(group: &Group, speed: f64, random: &mut Generator) -> Parameters {
    loop {
        let bare = without_friction(group, random);
        let damping = [random.within(group.damping), random.within(group.damping)];
        let viscous = [0, 1].map(|i| {
            let axis = axes(Model::Full, &bare)[i];
            2.0 * damping[i] * (axis.stiffness * axis.mass).sqrt()
        });
        let idlers = random.within([0.05, 0.5]);
        let coulomb = random.within([0.02, 0.3]);
        let r = bare.pulley_radius;
        // Up to eight idlers turn with the tool.
        let pulley = idlers * viscous[0].min(viscous[1]) / 8.0;
        let with = Parameters {
            pulley_viscous: pulley * r * r,
            pulley_coulomb: coulomb * pulley * speed * r,
            guide_coulomb: viscous.map(|b| coulomb * b * speed),
            ..bare
        };
        let [x, y] = axes(Model::Full, &with);
        let guides = [viscous[0] - x.viscous, viscous[1] - y.viscous];
        if guides.iter().all(|b| *b > 0.0) {
            return Parameters { guide_viscous: guides, ..with };
        }
    }
}

/// Belts, masses and pulleys.
fn without_friction(group: &Group, random: &mut Generator) -> Parameters {
    let belt = random.within(group.belt);
    Parameters {
        stiffness: [(); 5].map(|()| belt / random.within(group.section)),
        pulley_radius: random.within([5.0e-3, 6.5e-3]),
        effector_mass: random.within(group.mass),
        frame_mass: random.within(group.mass),
        pulley_mass: random.within([0.003, 0.010]),
        pulley_inertia: random.within([0.5e-7, 3e-7]),
        guide_viscous: [0.0; 2],
        guide_coulomb: [0.0; 2],
        pulley_viscous: 0.0,
        pulley_coulomb: 0.0,
        ..NOMINAL
    }
}
