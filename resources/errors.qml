<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis minScale="100000000" hasScaleBasedVisibilityFlag="0" version="3.22.16-Białowieża" styleCategories="Symbology|Labeling|Rendering" labelsEnabled="1" simplifyDrawingHints="1" symbologyReferenceScale="-1" simplifyMaxScale="1" simplifyLocal="1" simplifyAlgorithm="0" maxScale="0" simplifyDrawingTol="1">
 <renderer-v2 symbollevels="1" enableorderby="0" forceraster="0" type="RuleRenderer" referencescale="-1">
  <rules key="{errors}">
   <rule symbol="0" filter="&quot;error_m&quot; &lt;= 1" key="{error-0}" label="0" />
   <rule symbol="1" filter="&quot;error_m&quot; &gt; 1 AND &quot;error_m&quot; &lt;= 3" key="{error-1}" label="1" />
   <rule symbol="2" filter="&quot;error_m&quot; &gt; 3 AND &quot;error_m&quot; &lt;= 5" key="{error-2}" label="2" />
   <rule symbol="3" filter="&quot;error_m&quot; &gt; 5 AND &quot;error_m&quot; &lt;= 10" key="{error-3}" label="3" />
   <rule symbol="4" filter="&quot;error_m&quot; &gt; 10 AND &quot;error_m&quot; &lt;= 20" key="{error-4}" label="4" />
   <rule symbol="5" filter="&quot;error_m&quot; &gt; 20" key="{error-5}" label="5" />
   <rule symbol="6" filter="&quot;error_m&quot; IS NULL" key="{error-6}" label="6" />
  </rules>
  <symbols>
   <symbol name="0" alpha="1" force_rhr="0" type="marker" clip_to_extent="1">
    <layer locked="0" pass="1" enabled="1" class="GeometryGenerator">
     <Option type="Map">
      <Option name="SymbolType" type="QString" value="Line" />
      <Option name="geometryModifier" type="QString" value="make_line($geometry, make_point(&quot;predicted_lon_deg&quot; + 360 * round(($x - &quot;predicted_lon_deg&quot;) / 360), &quot;predicted_lat_deg&quot;))" />
     </Option>
     <symbol name="@0@0" alpha="1" force_rhr="0" type="line" clip_to_extent="1">
      <layer locked="0" pass="0" enabled="1" class="SimpleLine">
       <Option type="Map">
        <Option name="line_color" type="QString" value="32,32,32,255" />
        <Option name="line_width" type="QString" value="0.9" />
       </Option>
      </layer>
      <layer locked="0" pass="0" enabled="1" class="SimpleLine">
       <Option type="Map">
        <Option name="line_color" type="QString" value="69,117,180,255" />
        <Option name="line_width" type="QString" value="0.5" />
       </Option>
      </layer>
      <layer locked="0" pass="0" enabled="1" class="MarkerLine">
       <Option type="Map">
        <Option name="placement" type="QString" value="lastvertex" />
       </Option>
       <symbol name="@@0@0@2" alpha="1" force_rhr="0" type="marker" clip_to_extent="1">
        <layer locked="0" pass="0" enabled="1" class="SimpleMarker">
         <Option type="Map">
          <Option name="color" type="QString" value="255,255,255,255" />
          <Option name="name" type="QString" value="circle" />
          <Option name="outline_color" type="QString" value="69,117,180,255" />
          <Option name="outline_width" type="QString" value="0.5" />
          <Option name="size" type="QString" value="1.8" />
         </Option>
        </layer>
       </symbol>
      </layer>
     </symbol>
    </layer>
    <layer locked="0" pass="2" enabled="1" class="SimpleMarker">
     <Option type="Map">
      <Option name="color" type="QString" value="69,117,180,255" />
      <Option name="name" type="QString" value="circle" />
      <Option name="outline_color" type="QString" value="32,32,32,255" />
      <Option name="outline_width" type="QString" value="0.3" />
      <Option name="size" type="QString" value="3" />
     </Option>
    </layer>
   </symbol>
   <symbol name="1" alpha="1" force_rhr="0" type="marker" clip_to_extent="1">
    <layer locked="0" pass="1" enabled="1" class="GeometryGenerator">
     <Option type="Map">
      <Option name="SymbolType" type="QString" value="Line" />
      <Option name="geometryModifier" type="QString" value="make_line($geometry, make_point(&quot;predicted_lon_deg&quot; + 360 * round(($x - &quot;predicted_lon_deg&quot;) / 360), &quot;predicted_lat_deg&quot;))" />
     </Option>
     <symbol name="@1@0" alpha="1" force_rhr="0" type="line" clip_to_extent="1">
      <layer locked="0" pass="0" enabled="1" class="SimpleLine">
       <Option type="Map">
        <Option name="line_color" type="QString" value="32,32,32,255" />
        <Option name="line_width" type="QString" value="0.9" />
       </Option>
      </layer>
      <layer locked="0" pass="0" enabled="1" class="SimpleLine">
       <Option type="Map">
        <Option name="line_color" type="QString" value="145,191,219,255" />
        <Option name="line_width" type="QString" value="0.5" />
       </Option>
      </layer>
      <layer locked="0" pass="0" enabled="1" class="MarkerLine">
       <Option type="Map">
        <Option name="placement" type="QString" value="lastvertex" />
       </Option>
       <symbol name="@@1@0@2" alpha="1" force_rhr="0" type="marker" clip_to_extent="1">
        <layer locked="0" pass="0" enabled="1" class="SimpleMarker">
         <Option type="Map">
          <Option name="color" type="QString" value="255,255,255,255" />
          <Option name="name" type="QString" value="circle" />
          <Option name="outline_color" type="QString" value="145,191,219,255" />
          <Option name="outline_width" type="QString" value="0.5" />
          <Option name="size" type="QString" value="1.8" />
         </Option>
        </layer>
       </symbol>
      </layer>
     </symbol>
    </layer>
    <layer locked="0" pass="2" enabled="1" class="SimpleMarker">
     <Option type="Map">
      <Option name="color" type="QString" value="145,191,219,255" />
      <Option name="name" type="QString" value="circle" />
      <Option name="outline_color" type="QString" value="32,32,32,255" />
      <Option name="outline_width" type="QString" value="0.3" />
      <Option name="size" type="QString" value="3" />
     </Option>
    </layer>
   </symbol>
   <symbol name="2" alpha="1" force_rhr="0" type="marker" clip_to_extent="1">
    <layer locked="0" pass="1" enabled="1" class="GeometryGenerator">
     <Option type="Map">
      <Option name="SymbolType" type="QString" value="Line" />
      <Option name="geometryModifier" type="QString" value="make_line($geometry, make_point(&quot;predicted_lon_deg&quot; + 360 * round(($x - &quot;predicted_lon_deg&quot;) / 360), &quot;predicted_lat_deg&quot;))" />
     </Option>
     <symbol name="@2@0" alpha="1" force_rhr="0" type="line" clip_to_extent="1">
      <layer locked="0" pass="0" enabled="1" class="SimpleLine">
       <Option type="Map">
        <Option name="line_color" type="QString" value="32,32,32,255" />
        <Option name="line_width" type="QString" value="0.9" />
       </Option>
      </layer>
      <layer locked="0" pass="0" enabled="1" class="SimpleLine">
       <Option type="Map">
        <Option name="line_color" type="QString" value="224,243,248,255" />
        <Option name="line_width" type="QString" value="0.5" />
       </Option>
      </layer>
      <layer locked="0" pass="0" enabled="1" class="MarkerLine">
       <Option type="Map">
        <Option name="placement" type="QString" value="lastvertex" />
       </Option>
       <symbol name="@@2@0@2" alpha="1" force_rhr="0" type="marker" clip_to_extent="1">
        <layer locked="0" pass="0" enabled="1" class="SimpleMarker">
         <Option type="Map">
          <Option name="color" type="QString" value="255,255,255,255" />
          <Option name="name" type="QString" value="circle" />
          <Option name="outline_color" type="QString" value="224,243,248,255" />
          <Option name="outline_width" type="QString" value="0.5" />
          <Option name="size" type="QString" value="1.8" />
         </Option>
        </layer>
       </symbol>
      </layer>
     </symbol>
    </layer>
    <layer locked="0" pass="2" enabled="1" class="SimpleMarker">
     <Option type="Map">
      <Option name="color" type="QString" value="224,243,248,255" />
      <Option name="name" type="QString" value="circle" />
      <Option name="outline_color" type="QString" value="32,32,32,255" />
      <Option name="outline_width" type="QString" value="0.3" />
      <Option name="size" type="QString" value="3" />
     </Option>
    </layer>
   </symbol>
   <symbol name="3" alpha="1" force_rhr="0" type="marker" clip_to_extent="1">
    <layer locked="0" pass="1" enabled="1" class="GeometryGenerator">
     <Option type="Map">
      <Option name="SymbolType" type="QString" value="Line" />
      <Option name="geometryModifier" type="QString" value="make_line($geometry, make_point(&quot;predicted_lon_deg&quot; + 360 * round(($x - &quot;predicted_lon_deg&quot;) / 360), &quot;predicted_lat_deg&quot;))" />
     </Option>
     <symbol name="@3@0" alpha="1" force_rhr="0" type="line" clip_to_extent="1">
      <layer locked="0" pass="0" enabled="1" class="SimpleLine">
       <Option type="Map">
        <Option name="line_color" type="QString" value="32,32,32,255" />
        <Option name="line_width" type="QString" value="0.9" />
       </Option>
      </layer>
      <layer locked="0" pass="0" enabled="1" class="SimpleLine">
       <Option type="Map">
        <Option name="line_color" type="QString" value="254,224,144,255" />
        <Option name="line_width" type="QString" value="0.5" />
       </Option>
      </layer>
      <layer locked="0" pass="0" enabled="1" class="MarkerLine">
       <Option type="Map">
        <Option name="placement" type="QString" value="lastvertex" />
       </Option>
       <symbol name="@@3@0@2" alpha="1" force_rhr="0" type="marker" clip_to_extent="1">
        <layer locked="0" pass="0" enabled="1" class="SimpleMarker">
         <Option type="Map">
          <Option name="color" type="QString" value="255,255,255,255" />
          <Option name="name" type="QString" value="circle" />
          <Option name="outline_color" type="QString" value="254,224,144,255" />
          <Option name="outline_width" type="QString" value="0.5" />
          <Option name="size" type="QString" value="1.8" />
         </Option>
        </layer>
       </symbol>
      </layer>
     </symbol>
    </layer>
    <layer locked="0" pass="2" enabled="1" class="SimpleMarker">
     <Option type="Map">
      <Option name="color" type="QString" value="254,224,144,255" />
      <Option name="name" type="QString" value="circle" />
      <Option name="outline_color" type="QString" value="32,32,32,255" />
      <Option name="outline_width" type="QString" value="0.3" />
      <Option name="size" type="QString" value="3" />
     </Option>
    </layer>
   </symbol>
   <symbol name="4" alpha="1" force_rhr="0" type="marker" clip_to_extent="1">
    <layer locked="0" pass="1" enabled="1" class="GeometryGenerator">
     <Option type="Map">
      <Option name="SymbolType" type="QString" value="Line" />
      <Option name="geometryModifier" type="QString" value="make_line($geometry, make_point(&quot;predicted_lon_deg&quot; + 360 * round(($x - &quot;predicted_lon_deg&quot;) / 360), &quot;predicted_lat_deg&quot;))" />
     </Option>
     <symbol name="@4@0" alpha="1" force_rhr="0" type="line" clip_to_extent="1">
      <layer locked="0" pass="0" enabled="1" class="SimpleLine">
       <Option type="Map">
        <Option name="line_color" type="QString" value="32,32,32,255" />
        <Option name="line_width" type="QString" value="0.9" />
       </Option>
      </layer>
      <layer locked="0" pass="0" enabled="1" class="SimpleLine">
       <Option type="Map">
        <Option name="line_color" type="QString" value="252,141,89,255" />
        <Option name="line_width" type="QString" value="0.5" />
       </Option>
      </layer>
      <layer locked="0" pass="0" enabled="1" class="MarkerLine">
       <Option type="Map">
        <Option name="placement" type="QString" value="lastvertex" />
       </Option>
       <symbol name="@@4@0@2" alpha="1" force_rhr="0" type="marker" clip_to_extent="1">
        <layer locked="0" pass="0" enabled="1" class="SimpleMarker">
         <Option type="Map">
          <Option name="color" type="QString" value="255,255,255,255" />
          <Option name="name" type="QString" value="circle" />
          <Option name="outline_color" type="QString" value="252,141,89,255" />
          <Option name="outline_width" type="QString" value="0.5" />
          <Option name="size" type="QString" value="1.8" />
         </Option>
        </layer>
       </symbol>
      </layer>
     </symbol>
    </layer>
    <layer locked="0" pass="2" enabled="1" class="SimpleMarker">
     <Option type="Map">
      <Option name="color" type="QString" value="252,141,89,255" />
      <Option name="name" type="QString" value="circle" />
      <Option name="outline_color" type="QString" value="32,32,32,255" />
      <Option name="outline_width" type="QString" value="0.3" />
      <Option name="size" type="QString" value="3" />
     </Option>
    </layer>
   </symbol>
   <symbol name="5" alpha="1" force_rhr="0" type="marker" clip_to_extent="1">
    <layer locked="0" pass="1" enabled="1" class="GeometryGenerator">
     <Option type="Map">
      <Option name="SymbolType" type="QString" value="Line" />
      <Option name="geometryModifier" type="QString" value="make_line($geometry, make_point(&quot;predicted_lon_deg&quot; + 360 * round(($x - &quot;predicted_lon_deg&quot;) / 360), &quot;predicted_lat_deg&quot;))" />
     </Option>
     <symbol name="@5@0" alpha="1" force_rhr="0" type="line" clip_to_extent="1">
      <layer locked="0" pass="0" enabled="1" class="SimpleLine">
       <Option type="Map">
        <Option name="line_color" type="QString" value="32,32,32,255" />
        <Option name="line_width" type="QString" value="0.9" />
       </Option>
      </layer>
      <layer locked="0" pass="0" enabled="1" class="SimpleLine">
       <Option type="Map">
        <Option name="line_color" type="QString" value="215,48,39,255" />
        <Option name="line_width" type="QString" value="0.5" />
       </Option>
      </layer>
      <layer locked="0" pass="0" enabled="1" class="MarkerLine">
       <Option type="Map">
        <Option name="placement" type="QString" value="lastvertex" />
       </Option>
       <symbol name="@@5@0@2" alpha="1" force_rhr="0" type="marker" clip_to_extent="1">
        <layer locked="0" pass="0" enabled="1" class="SimpleMarker">
         <Option type="Map">
          <Option name="color" type="QString" value="255,255,255,255" />
          <Option name="name" type="QString" value="circle" />
          <Option name="outline_color" type="QString" value="215,48,39,255" />
          <Option name="outline_width" type="QString" value="0.5" />
          <Option name="size" type="QString" value="1.8" />
         </Option>
        </layer>
       </symbol>
      </layer>
     </symbol>
    </layer>
    <layer locked="0" pass="2" enabled="1" class="SimpleMarker">
     <Option type="Map">
      <Option name="color" type="QString" value="215,48,39,255" />
      <Option name="name" type="QString" value="circle" />
      <Option name="outline_color" type="QString" value="32,32,32,255" />
      <Option name="outline_width" type="QString" value="0.3" />
      <Option name="size" type="QString" value="3" />
     </Option>
    </layer>
   </symbol>
   <symbol name="6" alpha="1" force_rhr="0" type="marker" clip_to_extent="1">
    <layer locked="0" pass="2" enabled="1" class="SimpleMarker">
     <Option type="Map">
      <Option name="color" type="QString" value="255,255,255,255" />
      <Option name="name" type="QString" value="cross2" />
      <Option name="outline_color" type="QString" value="32,32,32,255" />
      <Option name="outline_width" type="QString" value="0.7" />
      <Option name="size" type="QString" value="2.6" />
     </Option>
    </layer>
   </symbol>
  </symbols>
 </renderer-v2>
 <labeling type="simple">
  <settings calloutType="simple">
   <text-style fieldName="format_number(&quot;error_m&quot;, if(&quot;error_m&quot; &lt; 10, 1, 0)) || ' m'" legendString="Aa" fontSize="8" multilineHeight="1" allowHtml="0" fontSizeUnit="Point" fontStrikeout="0" blendMode="0" fontLetterSpacing="0" capitalization="0" textOpacity="1" textColor="32,32,32,255" fontKerning="1" isExpression="1" fontUnderline="0" fontWordSpacing="0" textOrientation="horizontal" namedStyle="" fontFamily="Sans Serif" useSubstitutions="0" fontItalic="0" fontSizeMapUnitScale="3x:0,0,0,0,0,0" previewBkgrdColor="255,255,255,255" fontWeight="50">
    <families />
    <text-buffer bufferJoinStyle="128" bufferColor="255,255,255,255" bufferBlendMode="0" bufferDraw="1" bufferSize="0.80000000000000004" bufferSizeMapUnitScale="3x:0,0,0,0,0,0" bufferOpacity="1" bufferSizeUnits="MM" bufferNoFill="1" />
    <text-mask maskOpacity="1" maskType="0" maskedSymbolLayers="" maskSizeMapUnitScale="3x:0,0,0,0,0,0" maskSize="1.5" maskEnabled="0" maskJoinStyle="128" maskSizeUnits="MM" />
   </text-style>
   <text-format multilineAlign="3" decimals="3" placeDirectionSymbol="0" autoWrapLength="0" reverseDirectionSymbol="0" rightDirectionSymbol="&gt;" wrapChar="" plussign="0" useMaxLineLengthForAutoWrap="1" leftDirectionSymbol="&lt;" addDirectionSymbol="0" formatNumbers="0" />
   <placement lineAnchorClipping="0" layerType="UnknownGeometry" geometryGeneratorEnabled="0" polygonPlacementFlags="2" lineAnchorPercent="0.5" maxCurvedCharAngleIn="25" overrunDistance="0" rotationAngle="0" centroidWhole="0" quadOffset="4" repeatDistanceUnits="MM" geometryGeneratorType="PointGeometry" offsetUnits="MM" overrunDistanceUnit="MM" distMapUnitScale="3x:0,0,0,0,0,0" placement="6" overrunDistanceMapUnitScale="3x:0,0,0,0,0,0" geometryGenerator="" xOffset="0" dist="1" distUnits="MM" fitInPolygonOnly="0" predefinedPositionOrder="TR,TL,BR,BL,R,L,TSR,BSR" labelOffsetMapUnitScale="3x:0,0,0,0,0,0" repeatDistance="0" placementFlags="10" maxCurvedCharAngleOut="-25" yOffset="0" preserveRotation="1" offsetType="0" priority="5" lineAnchorType="0" centroidInside="0" repeatDistanceMapUnitScale="3x:0,0,0,0,0,0" rotationUnit="AngleDegrees" />
   <rendering scaleVisibility="0" obstacleType="1" obstacleFactor="1" scaleMin="0" maxNumLabels="2000" labelPerPart="0" fontLimitPixelSize="0" drawLabels="1" zIndex="0" fontMinPixelSize="0" obstacle="1" mergeLines="0" minFeatureSize="0" unplacedVisibility="0" limitNumLabels="0" displayAll="0" upsidedownLabels="0" fontMaxPixelSize="10000" scaleMax="0" />
  </settings>
 </labeling>
 <blendMode>0</blendMode>
 <featureBlendMode>0</featureBlendMode>
 <layerOpacity>1</layerOpacity>
 <layerGeometryType>0</layerGeometryType>
</qgis>
