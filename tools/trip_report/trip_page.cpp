#include "tools/trip_report/trip_page.h"

#include "controller/files/external_text.h"
#include "tools/trip_report/trip_sections.h"

namespace flexarm {

std::string TripPage(const std::filesystem::path& log, std::size_t number) {
  const TripReading reading = ReadTrip(log, number);
  HtmlPage page("Trip report of flexarm: " + std::string(ToString(reading.trip.after.cause)) +
                ", " + Shown(reading.head.info.rig_name) + ", " + TimeOfTrip(reading));
  WhatHappened(reading, &page);
  WhatToDo(reading, &page);
  ChainOfCauses(reading, &page);
  Signals(reading, &page);
  ThreadTiming(reading, &page);
  Buses(reading, &page);
  CommandsAndEvents(reading, &page);
  ConfigSection(reading, &page);
  AboutTheLog(reading, &page);
  return page.Text();
}

}  // namespace flexarm
