//! Enums whose variants have names in the language: each variant and its names stand in one line.

/// An enum with names: `Variant "name" | "another name";`, documented by the first name and what stands before.
macro_rules! named {
    (
        $(#[$meta:meta])*
        $vis:vis enum $of:ident {
            $($(#[$doc:meta])* $variant:ident $(= $code:literal)? $name:literal $(| $other:literal)*;)*
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, PartialEq, Eq, Debug)]
        $vis enum $of {
            $(#[doc = concat!("`", $name, "`")] $(#[$doc])* $variant $(= $code)?,)*
        }

        #[allow(dead_code, unreachable_pub)] // nobody asks all of them everything
        impl $of {
            /// All of them, in order.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// Its names, first the one that is written.
            pub const fn names(self) -> &'static [&'static str] {
                match self {
                    $(Self::$variant => &[$name $(, $other)*],)*
                }
            }

            /// Its name.
            pub const fn name(self) -> &'static str {
                self.names()[0]
            }

            /// The one of this name, in any case.
            pub fn named(name: &str) -> Option<Self> {
                let is = |n: &&str| n.eq_ignore_ascii_case(name);
                Self::ALL.iter().copied().find(|v| v.names().iter().any(is))
            }

            /// The name of the one of this code.
            pub(crate) fn name_of_code(code: f64) -> Option<&'static str> {
                let is = |v: &&Self| f64::from(**v as i32) == code;
                Self::ALL.iter().find(is).map(|v| v.name())
            }
        }
    };
}

/// The same of functions, with the least and the greatest number of arguments: `Variant "name", 1, 2;`.
macro_rules! functions {
    (
        $(#[$meta:meta])*
        $vis:vis enum $of:ident {
            $($(#[$doc:meta])* $variant:ident $name:literal $(| $other:literal)*, $least:expr, $most:expr;)*
        }
    ) => {
        $crate::model::named::named! {
            $(#[$meta])*
            $vis enum $of {
                $($(#[$doc])* $variant $name $(| $other)*;)*
            }
        }

        impl $of {
            /// The least and the greatest number of arguments.
            pub const fn arity(self) -> (usize, usize) {
                match self {
                    $(Self::$variant => ($least, $most),)*
                }
            }
        }
    };
}

pub(crate) use {functions, named};
