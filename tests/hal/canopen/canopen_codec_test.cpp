#include "hal/canopen/canopen_codec.h"

#include <gtest/gtest.h>

#include <initializer_list>

#include "hal/canopen/drive_state.h"
#include "hal/canopen/object_dictionary.h"
#include "hal/canopen/sdo.h"

namespace flexarm {
namespace {

CanFrame Frame(std::uint32_t id, std::initializer_list<int> bytes) {
  CanFrame frame{.id = id, .length = static_cast<std::uint8_t>(bytes.size())};
  std::size_t i = 0;
  for (const int byte : bytes) frame.data[i++] = static_cast<std::uint8_t>(byte);
  return frame;
}

// The expected bytes are taken from the protocol figures of CiA 301, not from our encoder.
TEST(CanopenCodec, NmtSyncAndHeartbeatAreTheBytesOfCia301) {
  EXPECT_EQ(EncodeNmt(NmtCommand::kStart, 0), Frame(0x000, {0x01, 0x00}));
  EXPECT_EQ(EncodeNmt(NmtCommand::kResetNode, 5), Frame(0x000, {0x81, 0x05}));
  EXPECT_EQ(EncodeNmt(NmtCommand::kResetCommunication, 127), Frame(0x000, {0x82, 0x7F}));
  EXPECT_EQ(EncodeSync(), Frame(0x080, {}));
  EXPECT_EQ(EncodeHeartbeat(5, NmtState::kBooting), Frame(0x705, {0x00}));
  EXPECT_EQ(EncodeHeartbeat(127, NmtState::kOperational), Frame(0x77F, {0x05}));
  EXPECT_EQ(DecodeHeartbeat(Frame(0x705, {0x7F})), NmtState::kPreOperational);
  EXPECT_EQ(DecodeHeartbeat(Frame(0x705, {0x06})), std::nullopt) << "no such state";
  EXPECT_EQ(DecodeHeartbeat(Frame(0x705, {0x05, 0x00})), std::nullopt) << "too long";
}

TEST(CanopenCodec, NmtCommandsAreDecodedAndInvalidOnesAreNot) {
  const std::optional<NmtOrder> order = DecodeNmt(Frame(0, {0x80, 0x03}));
  ASSERT_TRUE(order.has_value());
  EXPECT_EQ(order->command, NmtCommand::kPreOperational);
  EXPECT_EQ(order->node_id, 3);
  EXPECT_FALSE(DecodeNmt(Frame(0, {0x03, 0x03})).has_value());
  EXPECT_FALSE(DecodeNmt(Frame(0, {0x01})).has_value());
  EXPECT_FALSE(DecodeNmt(Frame(0, {0x01, 0x80})).has_value()) << "node ids end at 127";
}

// CiA 301 table of emergency codes: 8130h is the life guard or heartbeat error, register bit 4 is
// "communication".
TEST(CanopenCodec, EmergencyIsCodeRegisterAndFiveBytes) {
  const CanFrame frame = Frame(0x083, {0x30, 0x81, 0x11, 1, 2, 3, 4, 5});
  const Emergency emergency{
      .code = 0x8130, .error_register = 0x11, .vendor_bytes = {1, 2, 3, 4, 5}};
  EXPECT_EQ(EncodeEmergency(3, emergency), frame);
  const std::optional<Emergency> decoded = DecodeEmergency(frame);
  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(decoded->code, 0x8130);
  EXPECT_EQ(decoded->error_register, 0x11);
  EXPECT_EQ(decoded->vendor_bytes[4], 5);
  EXPECT_FALSE(DecodeEmergency(Frame(0x083, {0x30, 0x81, 0x11})).has_value());
}

TEST(CanopenCodec, TorquePdoIsControlwordThenTorqueLowByteFirst) {
  // 000Fh enable operation, -300 per mille = FED4h.
  const CanFrame frame = Frame(0x201, {0x0F, 0x00, 0xD4, 0xFE});
  EXPECT_EQ(EncodeDriveCommand(1, {.controlword = 0x000F, .torque_per_mille = -300}), frame);
  const std::optional<DriveCommand> decoded = DecodeDriveCommand(frame);
  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(decoded->torque_per_mille, -300);
  EXPECT_FALSE(DecodeDriveCommand(Frame(0x201, {0x0F, 0x00})).has_value());
}

TEST(CanopenCodec, DriveAndEncoderPdosAreDecodedWithTheirSigns) {
  // Statusword 0237h, position -2 = FFFFFFFEh, torque -5 = FFFBh.
  const CanFrame frame = Frame(0x182, {0x37, 0x02, 0xFE, 0xFF, 0xFF, 0xFF, 0xFB, 0xFF});
  const std::optional<DriveFeedback> feedback = DecodeDriveFeedback(frame);
  ASSERT_TRUE(feedback.has_value());
  EXPECT_EQ(feedback->statusword, 0x0237);
  EXPECT_EQ(feedback->position_counts, -2);
  EXPECT_EQ(feedback->torque_per_mille, -5);
  EXPECT_EQ(EncodeDriveFeedback(2, *feedback), frame);
  EXPECT_EQ(DecodeEncoderPosition(Frame(0x184, {0x78, 0x56, 0x34, 0x12})), 0x12345678U);
  EXPECT_EQ(EncodeEncoderPosition(4, 0x12345678U), Frame(0x184, {0x78, 0x56, 0x34, 0x12}));
  EXPECT_EQ(DecodeEncoderPosition(Frame(0x184, {0x78, 0x56})), std::nullopt);
}

TEST(CanopenCodec, MappingEntriesAreIndexSubIndexBits) {
  EXPECT_EQ(MappingEntry(kObjectControlword, 16), 0x60400010U);
  EXPECT_EQ(MappingEntry(kObjectPosition, 32), 0x60640020U);
}

// Worst-case stuffing: 55 bits without data, 135 with eight bytes (R. I. Davis et al. 2007).
TEST(CanopenCodec, WorstCaseFrameLengthsAgreeWithTheLiterature) {
  EXPECT_EQ(WorstCaseBits(0), 55);
  EXPECT_EQ(WorstCaseBits(8), 135);
  EXPECT_EQ(FrameTimeNs(8, 500'000), 270'000);
}

TEST(Sdo, WritesAreExpeditedWithTheirSize) {
  EXPECT_EQ(SdoWriteRequest(5, {0x1017, 0}, 1000, 2),
            Frame(0x605, {0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0x00, 0x00}));
  EXPECT_EQ(SdoWriteRequest(5, {0x6060, 0}, 10, 1),
            Frame(0x605, {0x2F, 0x60, 0x60, 0x00, 0x0A, 0x00, 0x00, 0x00}));
  EXPECT_EQ(SdoWriteRequest(5, {0x1016, 1}, 0x007F0064, 4),
            Frame(0x605, {0x23, 0x16, 0x10, 0x01, 0x64, 0x00, 0x7F, 0x00}));
  EXPECT_EQ(SdoWriteRequest(5, {0x60C2, 2}, 0xFFFFFFFD, 1).data[5], 0) << "-3 is one byte, FDh";
  EXPECT_EQ(SdoReadRequest(5, {0x1018, 1}),
            Frame(0x605, {0x40, 0x18, 0x10, 0x01, 0x00, 0x00, 0x00, 0x00}));
}

TEST(Sdo, RepliesAreValueWrittenOrAbort) {
  const SdoReply value = DecodeSdoReply(Frame(0x585, {0x4B, 0x17, 0x10, 0, 0xE8, 0x03, 0x99, 0}));
  EXPECT_EQ(value.kind, SdoReply::Kind::kValue);
  EXPECT_EQ(value.object, (CanopenObject{0x1017, 0}));
  EXPECT_EQ(value.size, 2);
  EXPECT_EQ(value.value, 1000U) << "bytes beyond the size are ignored";
  EXPECT_EQ(DecodeSdoReply(Frame(0x585, {0x42, 0x18, 0x10, 1, 4, 3, 2, 1})).value, 0x01020304U)
      << "size not given: four bytes";
  const SdoReply abort =
      DecodeSdoReply(Frame(0x585, {0x80, 0x07, 0x60, 0, 0x00, 0x00, 0x02, 0x06}));
  EXPECT_EQ(abort.kind, SdoReply::Kind::kAborted);
  EXPECT_STREQ(SdoAbortText(abort.value), "object does not exist in the object dictionary");
  EXPECT_STREQ(SdoAbortText(0x12345678), "unknown reason");
  EXPECT_EQ(DecodeSdoReply(Frame(0x585, {0x60, 0x17, 0x10, 0, 0, 0, 0, 0})).kind,
            SdoReply::Kind::kWritten);
  EXPECT_EQ(DecodeSdoReply(Frame(0x585, {0x41, 0x08, 0x10, 0, 9, 0, 0, 0})).kind,
            SdoReply::Kind::kMalformed)
      << "segmented";
  EXPECT_EQ(DecodeSdoReply(Frame(0x585, {0x60, 0x17, 0x10})).kind, SdoReply::Kind::kMalformed);
}

TEST(Sdo, TheClientDecodesTheServersReplies) {
  const CanopenObject object{0x1018, 2};
  const SdoReply value = DecodeSdoReply(SdoValueReply(9, object, 0xABCDEF, 3));
  EXPECT_EQ(value.value, 0xABCDEFU);
  EXPECT_EQ(value.size, 3);
  EXPECT_EQ(SdoAbortReply(9, object, kSdoAbortReadOnly),
            Frame(0x589, {0x80, 0x18, 0x10, 0x02, 0x02, 0x00, 0x01, 0x06}));
  EXPECT_EQ(SdoWrittenReply(9, object), Frame(0x589, {0x60, 0x18, 0x10, 0x02, 0, 0, 0, 0}));
  const SdoRequest request = DecodeSdoRequest(SdoWriteRequest(9, object, 7, 2));
  EXPECT_EQ(request.kind, SdoRequest::Kind::kWrite);
  EXPECT_EQ(request.size, 2);
  EXPECT_EQ(request.value, 7U);
  EXPECT_EQ(DecodeSdoRequest(Frame(0x609, {0x21, 0x18, 0x10, 2, 9, 0, 0, 0})).kind,
            SdoRequest::Kind::kMalformed)
      << "segmented";
}

// CiA 402, table of state coding: bits that are not part of a pattern are set and cleared here.
TEST(DriveState, StatuswordsAreDecodedByTheirPatternOnly) {
  struct Case {
    std::uint16_t care, bits;
    DriveState state;
  };
  using enum DriveState;
  const std::array cases = {Case{0x4F, 0x00, kNotReady},
                            Case{0x4F, 0x40, kSwitchOnDisabled},
                            Case{0x6F, 0x21, kReadyToSwitchOn},
                            Case{0x6F, 0x23, kSwitchedOn},
                            Case{0x6F, 0x27, kOperationEnabled},
                            Case{0x6F, 0x07, kQuickStopActive},
                            Case{0x4F, 0x0F, kFaultReactionActive},
                            Case{0x4F, 0x08, kFault}};
  int known = 0;
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    DriveState expected = kUnknown;
    for (const Case& c : cases) {
      if ((word & c.care) == c.bits) expected = c.state;
    }
    ASSERT_EQ(DecodeDriveState(static_cast<std::uint16_t>(word)), expected) << word;
    if (expected != kUnknown) ++known;
  }
  EXPECT_GT(known, 0);
  for (const Case& c : cases) EXPECT_EQ(DecodeDriveState(EncodeDriveState(c.state)), c.state);
}

TEST(DriveState, ADriveIsEnabledOneTransitionAtATime) {
  using enum DriveState;
  EXPECT_EQ(ControlwordFor(kSwitchOnDisabled, DriveWish::kOn), 0x06);
  EXPECT_EQ(ControlwordFor(kReadyToSwitchOn, DriveWish::kOn), 0x07);
  EXPECT_EQ(ControlwordFor(kSwitchedOn, DriveWish::kOn), 0x0F);
  EXPECT_EQ(ControlwordFor(kOperationEnabled, DriveWish::kOn), 0x0F);
}

TEST(DriveState, OnlyAResetLeavesAFaultAndOffWorksFromEveryState) {
  using enum DriveState;
  for (const DriveState state :
       {kUnknown, kNotReady, kSwitchOnDisabled, kReadyToSwitchOn, kSwitchedOn, kOperationEnabled,
        kQuickStopActive, kFaultReactionActive, kFault}) {
    EXPECT_EQ(ControlwordFor(state, DriveWish::kOff), 0x00);
    EXPECT_EQ(ControlwordFor(state, DriveWish::kResetFault), state == kFault ? 0x80 : 0x00);
    EXPECT_NE(ControlwordFor(state, DriveWish::kOn), 0x80);
  }
}

}  // namespace
}  // namespace flexarm
