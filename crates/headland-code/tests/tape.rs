//! The tape against the suite that every back end passes.

use headland_code::TapeFunction;

headland_code::evaluator_tests!(TapeFunction);
