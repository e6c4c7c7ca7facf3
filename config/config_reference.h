#pragma once

#include <string>
#include <vector>

namespace flexarm {

/// A table that a file may hold.
struct ListedTable {
  std::string name;  ///< as in a file: "[limits]", "[[hal.canopen.node]]"; "" for keys above them
  std::string path;  ///< "hal.canopen[].node[]"
  std::string meaning;
  bool is_optional;  ///< it may be left out as a whole
};

/// A key that a file may hold.
struct ListedKey {
  std::string path;   ///< "sensors.strain[].position_m": [] stands for the number of a row
  std::string table;  ///< the path of its table
  std::string name;   ///< "position_m"
  std::string type;   ///< "a finite number", "one of \"quintic\" \"septic\""
  std::string unit;   ///< "N m"; "" for texts, words and numbers without one
  std::string meaning;
  bool is_required;
  std::string without;             ///< the value without it, or "derived: how"; "" if there is none
  std::vector<std::string> rules;  ///< each as in messages: "must lie in 1 .. 6: .."
};

/// All keys of one kind of file, in the order in which they are read.
struct KeyListing {
  std::vector<ListedTable> tables;
  std::vector<ListedKey> keys;
};

/// The keys of a rig's config and of an experiment.
///
/// Found by running their readers (KeySurvey), the rules of the structs and the derivation, so that
/// nothing about a key is written twice. Takes some 10 ms.
KeyListing RigReference();
KeyListing ExperimentReference();

}  // namespace flexarm
