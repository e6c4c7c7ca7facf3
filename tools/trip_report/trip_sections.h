#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/html/html_page.h"
#include "tools/trip_report/trip_reading.h"

namespace flexarm {

/// A cause that was present in the window around a trip.
struct CauseSpan {
  TripCause cause;
  double from_s;                  ///< after the trip; kWindowBefore_s before it: or earlier
  std::optional<double> until_s;  ///< empty: until the end of the log
  std::string value, limit;       ///< with units; "-": not known
  std::string where;              ///< channel or bus; "": none
};

/// The latched cause first, then the others in order of time and number.
std::vector<CauseSpan> CausesOf(const TripReading& reading);

/// The event of this kind at the trip or first after it, as JSON; null: the log has none, as that
/// of a simulation.
nlohmann::json EventAtTrip(const TripReading& reading, const char* kind);

/// "+0.012 s".
std::string SignedSeconds(double s);

/// When the trip was: "2026-11-27T08:00:00Z".
std::string TimeOfTrip(const TripReading& reading);

// One function a section: adds it to the page.
void WhatHappened(const TripReading& reading, HtmlPage* page);
void WhatToDo(const TripReading& reading, HtmlPage* page);
void ChainOfCauses(const TripReading& reading, HtmlPage* page);
void Signals(const TripReading& reading, HtmlPage* page);
void ThreadTiming(const TripReading& reading, HtmlPage* page);
void Buses(const TripReading& reading, HtmlPage* page);
void CommandsAndEvents(const TripReading& reading, HtmlPage* page);
void ConfigSection(const TripReading& reading, HtmlPage* page);
void AboutTheLog(const TripReading& reading, HtmlPage* page);

}  // namespace flexarm
