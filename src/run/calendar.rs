//! Dates as numbers: days since 1899-12-31, with the time of day as fraction (jdate(1900,1,1) = 1).

use crate::check::node::DataFunction;
use jiff::civil::{Date, date};

const EPOCH: Date = date(1899, 12, 31);

/// Day number of a date.
pub fn jdate(year: f64, month: f64, day: f64) -> Option<f64> {
    let d = Date::new(year as i16, month as i8, day as i8).ok()?;
    Some(f64::from((d - EPOCH).get_days()))
}

/// A component of a day number.
pub fn part(f: DataFunction, x: f64) -> Option<f64> {
    use DataFunction as D;
    let days = x.floor();
    let d = EPOCH
        .checked_add(jiff::Span::new().try_days(days as i64).ok()?)
        .ok()?;
    let milliseconds = ((x - days) * 86_400_000.0).round();
    Some(match f {
        D::GYear => f64::from(d.year()),
        D::GMonth => f64::from(d.month()),
        D::GDay => f64::from(d.day()),
        D::GDow => f64::from(d.weekday().to_monday_one_offset()),
        D::GLeap => f64::from(u8::from(d.in_leap_year())),
        D::GHour => (milliseconds / 3_600_000.0).floor(),
        D::GMinute => (milliseconds / 60_000.0).floor() % 60.0,
        D::GSecond => (milliseconds / 1000.0).floor() % 60.0,
        D::GMillisec => milliseconds % 1000.0,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn day_numbers() {
        assert_eq!(jdate(1900.0, 1.0, 1.0), Some(1.0));
        assert_eq!(jdate(2000.0, 1.0, 1.0), Some(36525.0));
        assert_eq!(part(DataFunction::GDow, 36525.0), Some(6.0));
        assert_eq!(part(DataFunction::GLeap, 36525.0), Some(1.0));
        assert_eq!(part(DataFunction::GYear, 36525.5), Some(2000.0));
        assert_eq!(part(DataFunction::GHour, 36525.5), Some(12.0));
    }
}
