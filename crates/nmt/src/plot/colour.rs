//! Colours and colour maps.

/// A colour, `0xRRGGBB` in sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rgb(pub u32);

impl Rgb {
    pub const WHITE: Self = Self(0xffffff);
    pub const BLACK: Self = Self(0x000000);
    /// Frames, ticks, texts: softer than black, as dark in print.
    pub const INK: Self = Self(0x1a1a1a);

    fn channels(self) -> [f64; 3] {
        [16, 8, 0].map(|shift| f64::from((self.0 >> shift) & 0xff))
    }

    /// This colour with the share `share` (0 to 1) of `other` in it.
    pub fn mixed(self, other: Self, share: f64) -> Self {
        let (a, b) = (self.channels(), other.channels());
        let channel = |k: usize| (a[k] + (b[k] - a[k]) * share).round().clamp(0.0, 255.0) as u32;
        Self(channel(0) << 16 | channel(1) << 8 | channel(2))
    }
}

/// Colours of the subdomains: those of Okabe and Ito (2008), told apart by colour-blind readers too, without yellow and
/// black, which the page and the outline need, and with two more.
const SUBDOMAINS: [Rgb; 8] = [
    Rgb(0x0072b2),
    Rgb(0xd55e00),
    Rgb(0x009e73),
    Rgb(0xcc79a7),
    Rgb(0xe69f00),
    Rgb(0x56b4e9),
    Rgb(0x7a5195),
    Rgb(0x8c6d31),
];

/// Colour of the subdomain of this number; after eight they repeat.
pub(super) fn of_subdomain(number: usize) -> Rgb {
    SUBDOMAINS[number % SUBDOMAINS.len()]
}

/// A colour map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Map {
    /// From dark blue to yellow, for values that grow from one end: viridis.
    Sequential,
    /// From blue over near-white to red, for signed values: lightness falls alike on both sides.
    Diverging,
}

impl Map {
    /// Colour at `t`, 0 at the lower end and 1 at the upper; `t` outside is taken to the nearer end.
    pub fn at(self, t: f64) -> Rgb {
        let table = match self {
            Self::Sequential => &VIRIDIS,
            Self::Diverging => &BLUE_RED,
        };
        let s = t.clamp(0.0, 1.0) * (table.len() - 1) as f64;
        let i = (s as usize).min(table.len() - 2);
        Rgb(table[i]).mixed(Rgb(table[i + 1]), s - i as f64)
    }
}

/// Viridis at 33 even steps (S. van der Walt, N. Smith, E. Firing, 2015; dedicated to the public domain, CC0). Linear
/// interpolation is within 2/255 of the original table of 256.
#[rustfmt::skip]
const VIRIDIS: [u32; 33] = [
    0x440154, 0x470d60, 0x48186a, 0x482374, 0x472d7b, 0x453681, 0x424086, 0x3f4989, 0x3b528b, 0x375a8d, 0x33638d,
    0x2f6a8e, 0x2c728e, 0x297a8e, 0x26818e, 0x23898e, 0x21908c, 0x1f988b, 0x1f9f88, 0x21a685, 0x28ae80, 0x31b57b,
    0x3ebc74, 0x4cc26c, 0x5dc963, 0x6ece58, 0x82d34c, 0x96d83f, 0xabdc32, 0xc0df24, 0xd5e21a, 0xeae51a, 0xfde725,
];

/// Our own map, even in OKLab: lightness 0.97 in the middle falling linearly to 0.40 at both ends, hue 255° below and 30°
/// above the middle, chroma rising as a quarter sine to 0.155 at 0.8 of the way and easing to 0.125.
#[rustfmt::skip]
const BLUE_RED: [u32; 33] = [
    0x084689, 0x0d5099, 0x115aa9, 0x1664ba, 0x236fc6, 0x327ad1, 0x4185da, 0x5091e1, 0x609ce8, 0x71a8ed, 0x82b3f1,
    0x94bef4, 0xa7c9f6, 0xbad4f7, 0xcddff7, 0xe1eaf6, 0xf5f5f5, 0xf6e5e2, 0xf6d5cf, 0xf5c5bd, 0xf2b5ab, 0xefa699,
    0xea9688, 0xe58778, 0xde7969, 0xd66b5b, 0xcd5d4d, 0xc35040, 0xb84334, 0xab382a, 0x9c3125, 0x8c2b1f, 0x7d241a,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_ends_in_its_end_colours() {
        assert_eq!(Map::Sequential.at(0.0), Rgb(0x440154));
        assert_eq!(Map::Sequential.at(1.0), Rgb(0xfde725));
        assert_eq!(Map::Sequential.at(7.0), Rgb(0xfde725));
        assert_eq!(Map::Diverging.at(0.5), Rgb(0xf5f5f5));
    }

    #[test]
    fn lightness_grows_along_viridis_and_falls_from_the_middle_of_the_diverging_map() {
        // Rec. 709 weights on sRGB values: rough, but monotone in lightness.
        let luma = |c: Rgb| c.channels().iter().zip([0.2126, 0.7152, 0.0722]).map(|(v, w)| v * w).sum::<f64>();
        for k in 0..32 {
            let (a, b) = (f64::from(k) / 32.0, f64::from(k + 1) / 32.0);
            assert!(luma(Map::Sequential.at(a)) < luma(Map::Sequential.at(b)));
            let rises = luma(Map::Diverging.at(a)) < luma(Map::Diverging.at(b));
            assert_eq!(rises, k < 16);
        }
    }

    #[test]
    fn mixing_takes_the_stated_share() {
        assert_eq!(Rgb::BLACK.mixed(Rgb::WHITE, 0.5), Rgb(0x808080));
        assert_eq!(Rgb(0x123456).mixed(Rgb::WHITE, 0.0), Rgb(0x123456));
    }
}
