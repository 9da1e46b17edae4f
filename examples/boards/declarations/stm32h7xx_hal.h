#pragma once

/* What stm32h7_dcmi uses of ST's HAL and CMSIS, declared for compiling without them. */

#include <stdint.h>

typedef struct {
  void* Instance;
} DCMI_HandleTypeDef;
typedef enum { HAL_OK = 0, HAL_ERROR } HAL_StatusTypeDef;
#define DCMI_MODE_SNAPSHOT 2U

HAL_StatusTypeDef HAL_DCMI_Start_DMA(DCMI_HandleTypeDef* dcmi, uint32_t mode, uint32_t address,
                                     uint32_t words);
void HAL_DCMI_FrameEventCallback(DCMI_HandleTypeDef* dcmi);
void SCB_InvalidateDCache_by_Addr(void* address, int32_t bytes);
void __disable_irq(void);
void __enable_irq(void);
void __WFI(void);
