//! Values for reading a file: its unit, and the memory that it may take.

use super::Refused;
use super::number::{in_range, one};

/// The unit of a file in metres: its name, or a number.
pub fn unit(text: &str) -> Result<f32, Refused> {
    Ok(match text.trim() {
        "mm" => 1e-3,
        "cm" => 1e-2,
        "m" => 1.0,
        "km" => 1e3,
        "in" => 0.0254,
        "ft" => 0.3048,
        other => {
            let unit_m = one(other).map_err(|refused| match refused {
                Refused::Malformed(_) => Refused::Malformed(
                    "expected mm, cm, m, km, in, ft, or a number of metres, such as 0.01"
                        .to_owned(),
                ),
                Refused::OutOfRange(_) => refused,
            })?;
            in_range(unit_m, &(1e-9..=1e9), "the unit in metres")?
        }
    })
}

/// A number of bytes: a number with B, KiB, MiB, GiB or TiB, or with the decimal kB, MB, GB or TB.
pub fn bytes(text: &str) -> Result<u64, Refused> {
    const FORM: &str = "expected a size, such as 512MiB, 2GiB or 4GB";
    let text = text.trim();
    let (text, sign) = match text.strip_prefix('-') {
        Some(text) => (text, -1.0),
        None => (text, 1.0),
    };
    let digits = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let (value, unit) = text.split_at(digits);
    let value: f64 = value.parse().map_err(|_| Refused::Malformed(FORM.to_owned()))?;
    let factor: u64 = match unit.trim().to_ascii_lowercase().as_str() {
        "" | "b" => 1,
        "kb" => 1000,
        "mb" => 1_000_000,
        "gb" => 1_000_000_000,
        "tb" => 1_000_000_000_000,
        "kib" => 1 << 10,
        "mib" => 1 << 20,
        "gib" => 1 << 30,
        "tib" => 1 << 40,
        _ => return Err(Refused::Malformed(FORM.to_owned())),
    };
    let bytes = sign * value * factor as f64;
    if (f64::from(1 << 10)..=(1_u64 << 50) as f64).contains(&bytes) {
        return Ok(bytes as u64);
    }
    Err(Refused::OutOfRange("the size must be from 1 KiB to 1024 TiB".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_accepts_names_and_positive_lengths() {
        assert_eq!(unit("mm"), Ok(0.001));
        assert_eq!(unit("in"), Ok(0.0254));
        assert_eq!(unit("2.5"), Ok(2.5));
        for text in ["0", "-1", "1e10", "nan", "inf"] {
            assert!(matches!(unit(text), Err(Refused::OutOfRange(_))), "{text}");
        }
        for text in ["", "metre", "MM", "1 m"] {
            assert!(matches!(unit(text), Err(Refused::Malformed(_))), "{text}");
        }
    }

    #[test]
    fn byte_sizes_accept_decimal_and_binary_units() {
        for (power, [tens, twos]) in
            (1..).zip([["kB", "KiB"], ["MB", "MiB"], ["GB", "GiB"], ["TB", "TiB"]])
        {
            assert_eq!(bytes(&format!("4{tens}")), Ok(4 * 1000_u64.pow(power)), "{tens}");
            assert_eq!(bytes(&format!("1.5 {twos}")), Ok(3 << (10 * power - 1)), "{twos}");
        }
        assert_eq!(bytes("65536"), Ok(65_536));
        for text in ["0", "1023", "2000TiB", "99999999999999999999999999", "-1GiB", "-5"] {
            assert!(matches!(bytes(text), Err(Refused::OutOfRange(_))), "{text}");
        }
        for text in ["", "GiB", "-GiB", "--1", "2 G", "1e9", "2GiBs", "nan"] {
            assert!(matches!(bytes(text), Err(Refused::Malformed(_))), "{text}");
        }
    }
}
