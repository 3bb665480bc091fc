//! Fields made of fields.

/// A field that is another one, its only member.
macro_rules! forwarded {
    ($name:ty) => {
        $crate::field::combine::forwarded!($name, |field, sheet| field.0.operand(sheet));
    };
    ($name:ty, |$field:pat_param, $sheet:pat_param| $operand:expr) => {
        impl $crate::field::Field for $name {
            fn value(&self, p: [f64; 3]) -> f64 {
                self.0.value(p)
            }
            fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
                self.0.gradient(p)
            }
            fn value_and_gradient(&self, p: [f64; 3]) -> (f64, [f64; 3]) {
                self.0.value_and_gradient(p)
            }
            fn evaluate(&self, points: &[[f64; 3]], found: &mut [(f64, [f64; 3])]) {
                self.0.evaluate(points, found);
            }
            fn metric(&self) -> $crate::field::Metric {
                self.0.metric()
            }
            fn lipschitz(&self) -> f64 {
                self.0.lipschitz()
            }
            fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> $crate::field::Interval {
                self.0.bounds(low, high)
            }
            fn extent(&self) -> Option<[[f64; 3]; 2]> {
                self.0.extent()
            }
            fn sheets(&self) -> u32 {
                self.0.sheets()
            }
            fn sheet(&self, p: [f64; 3]) -> u32 {
                self.0.sheet(p)
            }
            fn on_sheet(&self, sheet: u32, p: [f64; 3]) -> (f64, [f64; 3]) {
                self.0.on_sheet(sheet, p)
            }
            fn is_flat(&self, sheet: u32) -> bool {
                self.0.is_flat(sheet)
            }
            fn operand(&self, sheet: u32) -> $crate::field::Operand {
                let ($field, $sheet) = (self, sheet);
                $operand
            }
        }
    };
}
use forwarded;

mod boolean;
mod offset;
mod placed;
mod smooth;
mod tagged;

pub use boolean::{Complement, Difference, Intersection, Union};
pub use offset::{Offset, Shell};
pub use placed::{Placed, Placement};
pub use smooth::SmoothUnion;
pub use tagged::Tagged;
