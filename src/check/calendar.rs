//! Dates as numbers: days since 1899-12-31, with the time of day as fraction (jdate(1900,1,1) = 1).

use super::node::DataFunction;
use crate::host::{EPOCH, date_of};
use jiff::civil::Date;

/// The days that have a number: of the years 1 to 9999.
const DAYS: std::ops::RangeInclusive<f64> = -693_594.0..=2_958_464.0;

/// Day number of a date. Month and day may lie outside their year and month: `jdate(2005, 14, -3)`.
pub fn jdate(year: f64, month: f64, day: f64) -> Option<f64> {
    let months = month.floor() - 1.0;
    let year = year.floor() + (months / 12.0).floor();
    let first = Date::new(year as i16, months.rem_euclid(12.0) as i8 + 1, 1).ok()?;
    let number = f64::from((first - EPOCH).get_days()) + day.floor() - 1.0;
    (year >= 1.0 && DAYS.contains(&number)).then_some(number)
}

/// A component of a day number.
pub fn part(f: DataFunction, x: f64) -> Option<f64> {
    use DataFunction as D;
    let days = x.floor();
    if !DAYS.contains(&days) {
        return None;
    }
    let d = date_of(days)?;
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
